#include "skinning/bake/bake.h"

#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <numbers>

#include "anatomy/errors.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/posing/posing_table.h"
#include "skinning/bake/bake_io.h"
#include "skinning/bake/bake_polish.h"
#include "skinning/bake/bake_weights.h"
#include "skinning/files/quantized_rotations.h"
#include "tests/skinning/arm.h"
#include "tests/skinning/compiled_arm.h"

namespace ecorche {
namespace {

// The arm of the skin tests, bending at the elbow over twenty frames.
struct BoundArm {
  test::Arm arm = test::make_arm();
  const Skeleton& skeleton = arm.anatomy.skeleton;
  PosingTable table = make_posing_table(arm.anatomy);
  PosedAnatomy posed;
  CharacterModel model = test::compile_without_collision(arm.anatomy, arm.skin);
  Binding binding = model.binding;
  BakedMotion bend;

  BoundArm() {
    bend.name = "bend";
    for (int f = 0; f < 20; ++f) {
      Pose pose = rest_pose(skeleton);
      pose.root += Vec3(0.01 * f, 0, 0);
      pose.rotations[find_joint(skeleton, "elbow_l")] =
          Quat(Eigen::AngleAxisd(-0.1 * f, Vec3::UnitX()));
      bend.motion.frames.push_back(pose);
    }
  }
  ExactSkin exact() {
    return [this](const Pose& pose, SkinFrame& out) {
      pose_anatomy(table, skeleton, pose, posed);
      out = test::skin_over(model, posed);
    };
  }
  Bake bake(int morphs, double least_offset = 1e-4, int helpers = 0) {
    BakeOptions options;
    options.morphs = morphs;
    options.helpers = helpers;
    options.helper_error = 1e-4;
    options.least_offset = least_offset;
    return bake_skin(arm.skin, skeleton, binding.joint_weights, exact(), {bend}, options);
  }
};

TEST(BakeWeights, FindWhatMadeTheData) {
  // Three joints put a vertex at e1, e2, e3 in turn over four frames; it was made with weights 0.7,
  // 0.3, 0.
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(3, 3);
  for (int f = 0; f < 4; ++f) {
    Eigen::MatrixXd D = Eigen::MatrixXd::Random(3, 3);
    D.colwise() -= Eigen::Vector3d(0.7 * D.col(0) + 0.3 * D.col(1));
    G += D.transpose() * D;
  }
  const Eigen::VectorXd w = simplex_weights(G, Eigen::Vector3d::Constant(1.0 / 3), 1e-12, 4);
  EXPECT_LT((w - Eigen::Vector3d(0.7, 0.3, 0)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(BakeWeights, AreOnTheSimplexAndNoneCanBeBettered) {
  std::srand(7);
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::Random(12, 8), G = A.transpose() * A;
    const Eigen::VectorXd start = Eigen::VectorXd::Constant(8, 1.0 / 8);
    const Eigen::VectorXd w = simplex_weights(G, start, 1e-9, 8);
    EXPECT_NEAR(w.sum(), 1, 1e-12);
    EXPECT_GE(w.minCoeff(), 0);
    for (int i = 0; i < 8; ++i)  // moving weight from any joint to any other costs
      for (int k = 0; k < 8; ++k) {
        if (i == k || w[i] < 1e-3) continue;
        Eigen::VectorXd other = w;
        other[i] -= 1e-4;
        other[k] += 1e-4;
        EXPECT_GE(other.dot(G * other), w.dot(G * w) - 1e-9);
      }
    const Eigen::VectorXd four = simplex_weights(G, start, 1e-9, 4);
    EXPECT_LE((four.array() > 0).count(), 4);
    EXPECT_NEAR(four.sum(), 1, 1e-12);
    EXPECT_GE(four.dot(G * four), w.dot(G * w) - 1e-9);
  }
}

TEST(Bake, ShapesTakeUpWhatInfluencesLeave) {
  BoundArm arm;
  const Bake none = arm.bake(0), few = arm.bake(3), all = arm.bake(32, 2e-5);
  EXPECT_EQ(none.morphs.size(), 0u);
  EXPECT_EQ(few.morphs.size(), 3u);
  EXPECT_GT(none.error.max, 1e-4);
  EXPECT_LT(few.error.rms, 0.06 * none.error.rms);
  // As many shapes as frames: only the offsets that are too small to keep are missing, a little
  // more of them where a fold presses its flesh: 0.2 mm, by one machine's rounding or another's.
  EXPECT_LT(all.error.max, 2.5e-4);
  EXPECT_EQ(none.error.frames, 20);
  EXPECT_LE(none.error.p95, none.error.max);
  EXPECT_LE(none.error.mean, none.error.rms);
  EXPECT_LT(few.error.normal_rms, 0.15 * none.error.normal_rms);
}

TEST(Bake, HelpersGoWhereJointsAloneLeaveTheSkinWorst) {
  BoundArm arm;
  const Bake none = arm.bake(0), few = arm.bake(0, 1e-4, 5);
  ASSERT_EQ(few.helpers.size(), 5u);
  EXPECT_LT(few.error.rms, 0.25 * none.error.rms);
  EXPECT_LT(few.error.max, 0.25 * none.error.max);
  for (const BakeHelper& helper : few.helpers)
    EXPECT_LT(std::size_t(helper.parent), arm.skeleton.joints.size());
  for (const auto& frame : few.motions[0].helpers)
    for (const Transform& X : frame)
      EXPECT_LT((X.linear() * X.linear().transpose() - Mat3::Identity()).norm(), 1e-9);
}

double cost(const Points& played, const Points& wanted) {
  double sum = 0;
  for (Eigen::Index i = 0; i < played.rows(); ++i) {
    const double e = (played.row(i) - wanted.row(i)).norm();
    sum += e * e / 2 + 3e-3 * 3e-3 / 12 * std::pow(e / 3e-3, 12);
  }
  return sum;
}

TEST(Bake, NoOtherCurveBringsAFrameCloser) {
  BoundArm arm;
  const Bake bake = arm.bake(4, 1e-4, 2);
  const BakedMotion& bend = bake.motions[0];
  std::vector<Transform> X_WJ;
  SkinFrame frame;
  Points played, wanted;
  for (std::size_t f = 0; f < 20; f += 3) {
    arm.exact()(arm.bend.motion.frames[f], frame);
    to_points(frame, wanted);
    forward_kinematics(arm.skeleton, quantized(arm.bend.motion.frames[f]), X_WJ);
    const Eigen::VectorXf best = bend.curves.row(f).transpose();
    play_bake(bake, arm.arm.skin, arm.skeleton, X_WJ, bend.helpers[f], best, played);
    const double least = cost(played, wanted);
    for (Eigen::Index m = 0; m < best.size(); ++m)
      for (const float by : {-0.05f, 0.05f}) {
        Eigen::VectorXf other = best;
        other[m] += by;
        play_bake(bake, arm.arm.skin, arm.skeleton, X_WJ, bend.helpers[f], other, played);
        EXPECT_GT(cost(played, wanted), 0.98 * least) << "frame " << f << ", curve " << m;
      }
  }
}

TEST(BakePolish, BringsTheFarthestCloserAndLeavesTheRestAlone) {
  std::srand(3);
  const Eigen::MatrixXd curves = Eigen::MatrixXd::Random(3, 12);
  std::vector<FrameResidual> frames(12);
  for (FrameResidual& frame : frames) {
    frame.blend = Rows9f::Zero(2, 9);
    frame.blend.col(0).setOnes(), frame.blend.col(5).setConstant(-1),
        frame.blend.col(7).setOnes();  // a quarter turn about x
    frame.residual = 1e-3f * Rows3f::Random(2, 3);
  }
  frames[4].residual.row(1) << 0.0f, 0.02f, 0.0f;
  Shapes shapes{Eigen::MatrixXf::Zero(6, 3)};
  polish_shapes(frames, curves, shapes);
  EXPECT_EQ(shapes.offsets.topRows(3), Eigen::MatrixXf::Zero(3, 3));
  double before = 0, after = 0;
  Mat3 turn;
  turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  for (std::size_t f = 0; f < 12; ++f) {
    const Vec3 left = frames[f].residual.row(1).transpose().cast<double>(),
               moved = turn * (shapes.offsets.bottomRows(3).cast<double>() * curves.col(f));
    before = std::max(before, left.norm());
    after = std::max(after, (left - moved).norm());
  }
  EXPECT_LT(after, 0.75 * before);
}

TEST(Bake, SolvedWeightsAreNoWorseThanTheGiven) {
  BoundArm arm;
  Bake given = arm.bake(0);
  const double solved = given.error.rms;
  given.influences = arm.binding.joint_weights;
  double squares = 0, count = 0;
  std::vector<Transform> X_WJ;
  SkinFrame frame;
  Points played, wanted;
  for (const Pose& pose : arm.bend.motion.frames) {
    arm.exact()(pose, frame);
    forward_kinematics(arm.skeleton, quantized(pose), X_WJ);
    play_bake(given, arm.arm.skin, arm.skeleton, X_WJ, {}, Eigen::VectorXf(), played);
    to_points(frame, wanted);
    squares += (played - wanted).squaredNorm();
    count += double(wanted.rows());
  }
  EXPECT_LT(solved, std::sqrt(squares / count));
}

TEST(Bake, InfluencesAreFourThatSumToOneAndCurvesStayWithinOne) {
  BoundArm arm;
  const Bake bake = arm.bake(8);
  for (const auto& four : bake.influences) {
    double sum = 0;
    for (const Influence& influence : four) {
      EXPECT_GE(influence.weight, 0);
      sum += influence.weight;
    }
    EXPECT_NEAR(sum, 1, 1e-9);
  }
  EXPECT_LE(bake.motions[0].curves.cwiseAbs().maxCoeff(), 1.0001f);
}

TEST(Bake, NothingToBakeIsSaid) {
  BoundArm arm;
  arm.bend.motion.frames.clear();
  EXPECT_THROW(arm.bake(4), UnfitError);
}

// Plays the file as an engine does, with nothing but what glTF says.
class Player {
 public:
  explicit Player(const std::string& file) {
    std::string error, warning;
    ok_ = tinygltf::TinyGLTF().LoadBinaryFromFile(&model_, &error, &warning, file);
    EXPECT_TRUE(ok_) << error;
  }
  const tinygltf::Model& model() const { return model_; }

  std::vector<float> floats(int accessor) const {
    const tinygltf::Accessor& a = model_.accessors[accessor];
    const std::size_t width = tinygltf::GetNumComponentsInType(std::uint32_t(a.type));
    std::vector<float> out(a.count * width, 0);
    if (a.componentType == TINYGLTF_COMPONENT_TYPE_SHORT) {
      EXPECT_TRUE(a.normalized);
      const auto* shares = reinterpret_cast<const std::int16_t*>(bytes(a.bufferView));
      for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = std::max(float(shares[i]) / 32767.0f, -1.0f);
      return out;
    }
    if (a.bufferView >= 0) std::memcpy(out.data(), bytes(a.bufferView), 4 * out.size());
    if (!a.sparse.isSparse) return out;
    EXPECT_EQ(a.sparse.indices.componentType,
              TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);  // enough for so small a skin
    const auto* places = reinterpret_cast<const std::uint16_t*>(bytes(a.sparse.indices.bufferView));
    const auto* values = reinterpret_cast<const float*>(bytes(a.sparse.values.bufferView));
    for (std::size_t i = 0; i < std::size_t(a.sparse.count); ++i)
      std::memcpy(&out[width * places[i]], &values[width * i], 4 * width);
    return out;
  }

  struct Played {
    Points places, normals;
  };
  Played play(std::size_t frame) const {
    std::vector<Eigen::Affine3d> local;
    for (const tinygltf::Node& node : model_.nodes) {
      Eigen::Affine3d X = Eigen::Affine3d::Identity();
      if (!node.translation.empty())
        X.translation() = Vec3(node.translation[0], node.translation[1], node.translation[2]);
      local.push_back(X);
    }
    std::vector<float> weights;
    for (const tinygltf::AnimationChannel& channel : model_.animations[0].channels) {
      const std::vector<float> v = floats(model_.animations[0].samplers[channel.sampler].output);
      Eigen::Affine3d& X = local[channel.target_node];
      if (channel.target_path == "translation")
        X.translation() = Vec3(v[3 * frame], v[3 * frame + 1], v[3 * frame + 2]);
      const std::size_t key = v.size() == 4 ? 0 : 4 * frame;  // a joint that stays has one
      if (channel.target_path == "rotation")
        X.linear() =
            Quat(v[key + 3], v[key], v[key + 1], v[key + 2]).normalized().toRotationMatrix();
      const std::size_t morphs = model_.meshes[0].weights.size();
      if (channel.target_path == "weights")
        weights.assign(v.begin() + std::ptrdiff_t(frame * morphs),
                       v.begin() + std::ptrdiff_t((frame + 1) * morphs));
    }
    std::vector<Eigen::Affine3d> world = local;
    for (std::size_t n = 0; n < model_.nodes.size(); ++n)  // parents come first
      for (int child : model_.nodes[n].children) world[child] = world[n] * local[child];
    const std::vector<float> inverse = floats(model_.skins[0].inverseBindMatrices);
    std::vector<Eigen::Affine3d> joints;
    for (std::size_t j = 0; j < model_.skins[0].joints.size(); ++j)
      joints.push_back(
          world[model_.skins[0].joints[j]] *
          Eigen::Affine3d(Eigen::Map<const Eigen::Matrix4f>(&inverse[16 * j]).cast<double>()));
    const tinygltf::Primitive& primitive = model_.meshes[0].primitives[0];
    std::vector<float> p = floats(primitive.attributes.at("POSITION"));
    std::vector<float> n = floats(primitive.attributes.at("NORMAL"));
    for (std::size_t m = 0; m < primitive.targets.size(); ++m) {
      const std::vector<float> shape = floats(primitive.targets[m].at("POSITION")),
                               turn = floats(primitive.targets[m].at("NORMAL"));
      for (std::size_t i = 0; i < p.size(); ++i) {
        p[i] += weights[m] * shape[i];
        n[i] += weights[m] * turn[i];
      }
    }
    const std::vector<float> shares = floats(primitive.attributes.at("WEIGHTS_0"));
    const auto* names = reinterpret_cast<const std::uint16_t*>(
        bytes(model_.accessors[primitive.attributes.at("JOINTS_0")].bufferView));
    const Points zero = Points::Zero(p.size() / 3, 3);
    Played out{zero, zero};
    for (Eigen::Index i = 0; i < zero.rows(); ++i) {
      const std::size_t v = 3 * std::size_t(i);
      for (Eigen::Index k = 0; k < 4; ++k) {
        const std::size_t at = 4 * i + k;
        out.places.row(i) += shares[at] * (joints[names[at]] * Vec3(p[v], p[v + 1], p[v + 2]));
        out.normals.row(i) +=
            shares[at] * (joints[names[at]].linear() * Vec3(n[v], n[v + 1], n[v + 2]));
      }
    }
    return out;
  }

 private:
  const unsigned char* bytes(int view) const {
    const tinygltf::BufferView& v = model_.bufferViews[view];
    return model_.buffers[0].data.data() + v.byteOffset;
  }
  tinygltf::Model model_;
  bool ok_ = false;
};

TEST(Bake, TheFilePlaysAsStatedByAReaderOfItsOwn) {
  BoundArm arm;
  const Bake bake = arm.bake(8, 1e-4, 3);
  ASSERT_EQ(bake.helpers.size(), 3u);
  const std::string file = ::testing::TempDir() + "bake_" + std::to_string(::getpid()) + ".glb";
  write_bake(file, "arm", arm.arm.skin, arm.skeleton, bake);
  const Player player(file);
  std::filesystem::remove(file);
  SkinFrame frame;
  Points exact;
  double worst = 0, squares = 0, count = 0, angles = 0;
  for (std::size_t f = 0; f < 20; ++f) {
    const auto [played, normals] = player.play(f);
    arm.exact()(arm.bend.motion.frames[f], frame);
    for (Eigen::Index i = 0; i < normals.rows(); ++i) {
      const Vec3 there = Vec3(normals.row(i)).normalized();
      const Vec3 wanted = Eigen::Map<const Eigen::Vector3f>(&frame.normals[4 * i]).cast<double>();
      angles +=
          std::pow(std::acos(std::clamp(there.dot(wanted), -1.0, 1.0)) * 180 / std::numbers::pi, 2);
    }
    to_points(frame, exact);
    worst = std::max(worst, (played - exact).rowwise().norm().maxCoeff());
    squares += (played - exact).squaredNorm();
    count += double(exact.rows());
  }
  EXPECT_NEAR(worst, bake.error.max, 2e-6);
  EXPECT_NEAR(std::sqrt(squares / count), bake.error.rms, 2e-6);
  EXPECT_NEAR(std::sqrt(angles / count), bake.error.normal_rms, 1e-2);
  const tinygltf::Value& stated = player.model().scenes[0].extras.Get("bake").Get("error");
  EXPECT_NEAR(stated.Get("max").GetNumberAsDouble(), worst, 2e-6);
  EXPECT_EQ(stated.Get("frames").GetNumberAsInt(), 20);
}

}  // namespace
}  // namespace ecorche
