#include "morph/shapes/example_synthesizer.h"

#include <cmath>

#include <Eigen/Geometry>

#include "anatomy/compute/eigenvectors.h"
#include "morph/shapes/shape_examples.h"

namespace ecorche::inline v1 {
namespace {

// Spreads of the examples along one axis of the measures beyond which they tell nothing: networks
// extrapolate there. More: bodies out of human shape for measures that the examples do not have
// together; less: tall, short and heavy people are drawn to the mean.
constexpr double kFarthest = 2.5;

constexpr double kVariance = 0.99;  // share that the components kept carry

Eigen::VectorXd joints_of(const Rig& rig) {
  Eigen::VectorXd out(6 * Eigen::Index(rig.heads.size()));
  for (std::size_t b = 0; b < rig.heads.size(); ++b)
    out.segment<6>(6 * Eigen::Index(b)) << rig.heads[b], rig.tails[b];
  return out;
}

// The template carried by its skeleton: each bone turns its part the shortest way, stretches it
// along itself and takes it along.
Points carried(const Points& skin, const VertexWeights& weights, const Eigen::VectorXd& from,
               const Eigen::VectorXd& to) {
  const Eigen::Index bones = from.size() / 6;
  std::vector<Mat3> turn(bones, Mat3::Identity());
  for (Eigen::Index b = 0; b < bones; ++b) {
    const Vec3 before = from.segment<3>(6 * b + 3) - from.segment<3>(6 * b),
               after = to.segment<3>(6 * b + 3) - to.segment<3>(6 * b);
    if (before.norm() < 1e-6 || after.norm() < 1e-6) continue;
    const Vec3 axis = before.normalized();
    const Mat3 stretch =
        Mat3::Identity() + (after.norm() / before.norm() - 1) * axis * axis.transpose();
    turn[b] = Eigen::Quaterniond::FromTwoVectors(before, after).toRotationMatrix() * stretch;
  }
  Points out = Points::Zero(skin.rows(), 3);
  for (Eigen::Index v = 0; v < skin.rows(); ++v) {
    const std::size_t i = v;
    for (int e = weights.start[i]; e < weights.start[i + 1]; ++e) {
      const std::size_t b = weights.bone[e];
      const Eigen::Index at = 6 * Eigen::Index(b);
      const Vec3 p = to.segment<3>(at) + turn[b] * (skin.row(v).transpose() - from.segment<3>(at));
      out.row(v) += weights.weight[e] * p.transpose();
    }
  }
  return out;
}

// Components of columns and a network for each, from scaled inputs (#examples x 8).
ComponentSynthesizer learn_components(const Eigen::MatrixXd& columns,
                                      const Eigen::MatrixXd& inputs) {
  ComponentSynthesizer out;
  out.mean = columns.rowwise().mean();
  const Eigen::MatrixXd apart = columns.colwise() - out.mean;
  const SymmetricEigen<Eigen::Dynamic> gram =
      symmetric_eigen<Eigen::Dynamic>(apart.transpose() * apart);
  const Eigen::VectorXd variance = gram.values.reverse().cwiseMax(0);
  const double total = variance.sum();
  Eigen::Index used = 0;
  for (double sum = 0; used < variance.size() && sum < kVariance * total; ++used)
    sum += variance[used];
  const Eigen::MatrixXd vectors = gram.vectors.rowwise().reverse().leftCols(used);
  out.basis = apart * vectors * variance.head(used).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd scores = apart.transpose() * out.basis;
  out.left_out.resize(columns.cols(), used);
  for (Eigen::Index k = 0; k < used; ++k) {
    RadialOptions options;
    options.seed = std::uint32_t(k + 1);
    Eigen::VectorXd left_out;
    out.networks.push_back(learn_network(inputs, scores.col(k), options, &left_out));
    out.left_out.col(k) = left_out;
  }
  return out;
}

Eigen::VectorXd predicted(const ComponentSynthesizer& part, const Eigen::VectorXd& input) {
  Eigen::VectorXd scores(part.networks.size());
  for (Eigen::Index k = 0; k < scores.size(); ++k) scores[k] = evaluate(part.networks[k], input);
  return part.mean + part.basis * scores;
}

Points body_of(const ExampleSynthesizer& s, const Eigen::VectorXd& joints,
               const Eigen::VectorXd& displacement) {
  Points out = carried(s.skin, s.weights, s.joints, joints);
  out += Eigen::Map<const Points>(displacement.data(), out.rows(), 3);
  out.col(1).array() -= out.col(1).minCoeff();
  return out;
}

std::array<double, 8> eight_of(const TapeMeasure& tape, const Points& skin) {
  std::array<double, 8> out{};
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = tape.take(tape.table().at(kPaperMeasures[k]), skin);
  return out;
}

}  // namespace

ExampleSynthesizer learn_synthesizer(const BodyPackage& package, const TapeMeasure& tape, Sex sex,
                                     int count) {
  const Eigen::Index n = package.skin_size;
  ExampleSynthesizer out;
  Macros average;
  average.male = sex == Sex::male ? 1 : 0;
  const Points base = shape_points(package, average);
  const Rig rig = read_rig(package, "cmu_mb", base);
  out.skin = base.topRows(n);
  out.weights = rig.weights;
  out.joints = joints_of(rig);
  Eigen::MatrixXd joints(out.joints.size(), count), displacements(3 * n, count), measures(count, 8);
  for (int i = 0; i < count; ++i) {
    Points shape = shape_points(package, example_macros(sex, i));
    shape.col(1).array() -= shape.col(1).head(n).minCoeff();
    joints.col(i) = joints_of(read_rig(package, "cmu_mb", shape));
    const Points skin = shape.topRows(n),
                 rest = skin - carried(out.skin, out.weights, out.joints, joints.col(i));
    displacements.col(i) = Eigen::Map<const Eigen::VectorXd>(rest.data(), rest.size());
    const std::array<double, 8> own = eight_of(tape, skin);
    for (int k = 0; k < 8; ++k) measures(i, k) = own[k];
  }
  out.input_mean = measures.colwise().mean();
  const Eigen::MatrixXd apart = measures.rowwise() - out.input_mean.transpose();
  const SymmetricEigen<Eigen::Dynamic> axes =
      symmetric_eigen<Eigen::Dynamic>(apart.transpose() * apart / double(count - 1));
  out.input_scale =
      axes.values.cwiseMax(1e-8).cwiseSqrt().cwiseInverse().asDiagonal() * axes.vectors.transpose();
  const Eigen::MatrixXd inputs = apart * out.input_scale.transpose();
  out.joint = learn_components(joints, inputs);
  out.displacement = learn_components(displacements, inputs);
  return out;
}

Points synthesize(const ExampleSynthesizer& s, const std::array<double, 8>& measures) {
  const Eigen::VectorXd input =
      (s.input_scale * (Eigen::Map<const Eigen::VectorXd>(measures.data(), 8) - s.input_mean))
          .cwiseMax(-kFarthest)
          .cwiseMin(kFarthest);
  return body_of(s, predicted(s.joint, input), predicted(s.displacement, input));
}

std::vector<LeftOut> cross_validate(const BodyPackage& package, const TapeMeasure& tape, Sex sex,
                                    const ExampleSynthesizer& s) {
  const Eigen::Index count = s.joint.left_out.rows();
  Eigen::MatrixXd own(count, 8), back(count, 8);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Points skin =
        shape_points(package, example_macros(sex, int(i))).topRows(package.skin_size);
    const Points left_out = body_of(
        s, s.joint.mean + s.joint.basis * s.joint.left_out.row(i).transpose(),
        s.displacement.mean + s.displacement.basis * s.displacement.left_out.row(i).transpose());
    const std::array<double, 8> a = eight_of(tape, skin), b = eight_of(tape, left_out);
    for (int k = 0; k < 8; ++k) own(i, k) = a[k], back(i, k) = b[k];
  }
  std::vector<LeftOut> out;
  for (int k = 0; k < 8; ++k) {
    const Eigen::VectorXd x = own.col(k).array() - own.col(k).mean(),
                          y = back.col(k).array() - back.col(k).mean();
    out.push_back({kPaperMeasures[k], x.dot(y) / (x.norm() * y.norm()),
                   (own.col(k) - back.col(k)).cwiseAbs().mean(), own.col(k).mean()});
  }
  return out;
}

}  // namespace ecorche::inline v1
