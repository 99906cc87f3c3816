#include "skinning/dynamics/segment_inertia.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/mesh_rims.h"
#include "anatomy/geometry/solid_moments.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/queries/nearest_surface.h"
#include "morph/fat/body_composition.h"
#include "morph/fat/muscle_mass.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

// kg/m^3; sources in the header.
constexpr double kBone = 1300, kSkin = 1100, kOrgans = 1050, kBrain = 1040, kLungs = 260;
constexpr double kSkinThickness = 0.0013;     // m
constexpr double kLungTissue = 1.1e-3;        // m^3, with blood (ICRP 89: 1.2 kg)
constexpr double kFatInAdiposeTissue = 0.85;  // by mass (ICRP 89)
constexpr double kAgeUnknown = 30;            // years
constexpr double kPlaneReach = 0.1;           // m
// Share of -1 .. 1, the weights' lean to a side, in which the plane decides. The hip's plane cuts
// aslant through buttock and groin, where weights are spread wide.
constexpr double kOpenLean = 0.6, kOpenHipLean = 0.85;
constexpr double kSureLean = 20;            // what a whole lean counts, in heights of kPlaneReach
constexpr double kHipPlane = 37 * kDegree;  // to the mid-plane (Zatsiorsky 1983)
constexpr double kSkullPlane = 40 * kDegree, kNeckPlane = 25 * kDegree;  // to the horizontal

enum class Filling { organs, brain, fat };

struct SegmentRule {
  const char* name;
  const char* parent;  // segment; "" for the one that has what is left
  const char* cut;     // joint at whose plane the segment and what lies beyond it begin
  const char* joint;   // that carries it
  Filling filling;
  bool paired;
};

// Parents before children. Trunk: the cuts of de Leva (1996), navel and xiphoid process, lie next
// to the joints below L4 and below T9.
constexpr std::array kRules{
    SegmentRule{"lower_trunk", "", "pelvis", "pelvis", Filling::organs, false},
    SegmentRule{"middle_trunk", "lower_trunk", "l4", "l2", Filling::organs, false},
    SegmentRule{"upper_trunk", "middle_trunk", "thorax", "thorax", Filling::organs, false},
    SegmentRule{"neck", "upper_trunk", "c7", "c5", Filling::organs, false},
    SegmentRule{"head", "neck", "head", "head", Filling::brain, false},
    SegmentRule{"upper_arm", "upper_trunk", "shoulder", "shoulder", Filling::fat, true},
    SegmentRule{"forearm", "upper_arm", "elbow", "elbow", Filling::fat, true},
    SegmentRule{"hand", "forearm", "wrist", "wrist", Filling::fat, true},
    SegmentRule{"thigh", "lower_trunk", "hip", "hip", Filling::fat, true},
    SegmentRule{"shank", "thigh", "knee", "knee", Filling::fat, true},
    SegmentRule{"foot", "shank", "ankle", "subtalar", Filling::fat, true}};

struct Piece {
  std::string name;
  int parent = -1, cut = 0, joint = 0;
  Filling filling = Filling::organs;
  Vec3 apex = Vec3::Zero(), normal = Vec3::Zero();  // of the cut, to the far side
  double open = kOpenLean;                          // lean of weights up to which the plane decides
  std::vector<double> sides;                        // #V: above 0 on the far side
  SolidMoments skin, bones, muscles, lungs;         // of this piece alone
  double skin_area = 0;
};

// Towards the far side of a joint's cut.
Vec3 cut_normal(const SegmentRule& rule, const std::string& suffix, const Skeleton& skeleton,
                const std::vector<Vec3>& rest) {
  const std::string name = rule.cut;
  const auto at = [&](const std::string& joint) {
    return rest[joint_of(skeleton, joint + suffix)];
  };
  const Vec3 out = suffix == "_r" ? Vec3(-1, 0, 0) : Vec3(1, 0, 0);
  const auto towards = [&](const char* from, const char* to) -> Vec3 {
    return (at(to) - at(from)).normalized();
  };
  if (name == "head") return {0, std::cos(kSkullPlane), std::sin(kSkullPlane)};
  if (name == "c7") return {0, std::cos(kNeckPlane), std::sin(kNeckPlane)};
  if (name == "shoulder") return (out + 0.3 * towards("shoulder", "elbow")).normalized();
  if (name == "elbow")
    return (towards("shoulder", "elbow") + towards("elbow", "wrist")).normalized();
  if (name == "wrist") return (towards("elbow", "wrist") + towards("wrist", "mcp3")).normalized();
  if (name == "hip") return std::cos(kHipPlane) * out - std::sin(kHipPlane) * Vec3::UnitY();
  if (name == "knee") return (towards("hip", "knee") + towards("knee", "ankle")).normalized();
  if (name == "ankle") return towards("knee", "ankle");
  return Vec3::UnitY();
}

// Height over the plane where weights leave the side open, the weights' word elsewhere.
double side_of(const Piece& piece, const Vec3& place, double weight) {
  const double lean = 2 * weight - 1;
  return (place - piece.apex).dot(piece.normal) / kPlaneReach +
         (lean > 0 ? 1 : -1) * kSureLean * std::max(0.0, std::abs(lean) - piece.open) /
             (1 - piece.open);
}

TriMesh closed(const TriMesh& skin) {
  std::vector<int> all(skin.F.rows());
  for (std::size_t f = 0; f < all.size(); ++f) all[f] = int(f);
  std::vector<MeshRim> rims = open_rims(all, skin.F);
  TriMesh out = skin;
  for (const MeshRim& rim : rims) {
    Vec3 middle = Vec3::Zero();
    for (const auto& edge : rim) middle += Vec3(skin.V.row(edge[0])) / double(rim.size());
    const Eigen::Index v = out.V.rows(), f = out.F.rows();
    out.V.conservativeResize(v + 1, 3);
    out.V.row(v) = middle;
    out.F.conservativeResize(f + Eigen::Index(rim.size()), 3);
    for (std::size_t k = 0; k < rim.size(); ++k)
      out.F.row(f + Eigen::Index(k)) << rim[k][0], rim[k][1], int(v);
  }
  return out;
}

std::vector<char> joints_beyond(const Skeleton& skeleton, int joint) {
  std::vector<char> out(skeleton.joints.size(), 0);
  out[joint] = 1;
  for (std::size_t j = std::size_t(joint) + 1; j < out.size(); ++j)
    out[j] = out[skeleton.joints[j].parent];
  return out;
}

class Cuts {
 public:
  Cuts(const Anatomy& anatomy, const Body& body, std::span<const JointWeights> weights)
      : anatomy_(anatomy), skin_(closed(body.skin)), nearest_(skin_) {
    const std::vector<Vec3> rest = rest_positions(anatomy.skeleton);
    for (const SegmentRule& rule : kRules)
      for (const std::string suffix : {"_l", "_r"}) {
        if (!rule.paired && suffix == "_r") continue;
        add(rule, rule.paired ? suffix : "", rest, weights);
      }
    cut_skin();
  }

  std::vector<Piece>& pieces() { return pieces_; }

  // The piece that holds a place inside the body.
  std::size_t piece_at(const Vec3& place) const {
    const int v = skin_.F(nearest_.nearest(place).triangle, 0);
    std::size_t out = 0;
    for (std::size_t k = 1; k < pieces_.size(); ++k)
      if (std::size_t(pieces_[k].parent) == out &&
          side_of(pieces_[k], place, vertex_weights_[k][v]) > 0)
        out = k;
    return out;
  }
  std::size_t piece_of(int joint) const {
    std::size_t out = 0;
    for (std::size_t k = 1; k < pieces_.size(); ++k)
      if (beyond_[k][joint]) out = k;
    return out;
  }

 private:
  void add(const SegmentRule& rule, const std::string& suffix, const std::vector<Vec3>& rest,
           std::span<const JointWeights> weights) {
    const Skeleton& skeleton = anatomy_.skeleton;
    Piece piece;
    piece.name = rule.name + suffix;
    for (std::size_t k = 0; k < pieces_.size(); ++k)
      if (pieces_[k].name == rule.parent || pieces_[k].name == rule.parent + suffix)
        piece.parent = int(k);
    piece.cut = joint_of(skeleton, rule.cut + suffix);
    piece.joint = joint_of(skeleton, rule.joint + suffix);
    piece.filling = rule.filling;
    piece.apex = rest[piece.cut];
    if (std::string(rule.cut) == "hip") piece.open = kOpenHipLean;
    piece.normal = cut_normal(rule, suffix, skeleton, rest);
    beyond_.push_back(joints_beyond(skeleton, piece.cut));
    std::vector<double> shares(skin_.V.rows(), 0.5);
    for (std::size_t v = 0; v < weights.size(); ++v) {
      shares[v] = 0;
      for (const Influence& influence : weights[v])
        if (beyond_.back()[influence.joint]) shares[v] += influence.weight;
    }
    piece.sides.resize(shares.size());
    for (std::size_t v = 0; v < shares.size(); ++v)
      piece.sides[v] =
          piece.parent < 0 ? 1 : side_of(piece, skin_.V.row(Eigen::Index(v)), shares[v]);
    vertex_weights_.push_back(std::move(shares));
    pieces_.push_back(std::move(piece));
  }

  void cut_skin() {
    std::vector<SolidMoments> whole;
    for (const Piece& piece : pieces_)
      whole.push_back(solid_moments_above(skin_, piece.sides, piece.apex));
    const std::vector<double> areas = vertex_areas(skin_);
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
      pieces_[k].skin = whole[k];
      for (std::size_t child = k + 1; child < pieces_.size(); ++child)
        if (pieces_[child].parent == int(k)) add_moments(whole[child], -1, pieces_[k].skin);
    }
    for (std::size_t v = 0; v < areas.size(); ++v) {
      std::size_t at = 0;
      for (std::size_t k = 1; k < pieces_.size(); ++k)
        if (std::size_t(pieces_[k].parent) == at && pieces_[k].sides[v] > 0) at = k;
      pieces_[at].skin_area += areas[v];
    }
  }

  const Anatomy& anatomy_;
  TriMesh skin_;
  NearestSurface nearest_;
  std::vector<Piece> pieces_;
  std::vector<std::vector<char>> beyond_;            // #pieces x #joints
  std::vector<std::vector<double>> vertex_weights_;  // #pieces x #V
};

double area_of(const Ellipse& e) {
  double sum = 0;
  for (int i = 0; i < kOutlinePoints; ++i)
    sum += double(e.outline[i]) * double(e.outline[(i + 1) % kOutlinePoints]);
  return 0.5 * e.radii.prod() * sum * std::sin(2 * std::numbers::pi / kOutlinePoints);
}

// A strip as a row of discs, each where its middle lies.
void add_muscle(const Strip& strip, const Cuts& cuts, std::vector<Piece>& pieces) {
  const std::vector<Ellipse> slices = rest_slices(strip);
  for (std::size_t k = 0; k + 1 < slices.size(); ++k) {
    const Ellipse &a = slices[k], &b = slices[k + 1];
    const Vec3 along = b.center - a.center;
    const double volume = 0.5 * along.norm() * (area_of(a) + area_of(b));
    if (!(volume > 0)) continue;
    const Vec3 middle = 0.5 * (a.center + b.center), u = a.axes.col(0), v = a.axes.col(1);
    const Vec2 radii = 0.5 * (a.radii + b.radii);
    SolidMoments disc;
    disc.volume = volume;
    disc.first = volume * middle;
    disc.second = volume * (middle * middle.transpose() + along * along.transpose() / 12 +
                            std::pow(radii.x() / 2, 2) * u * u.transpose() +
                            std::pow(radii.y() / 2, 2) * v * v.transpose());
    add_moments(disc, 1, pieces[cuts.piece_at(middle)].muscles);
  }
}

// m^3: functional residual capacity and the tissue.
double lung_volume(const Body& body, double stature) {
  const double age = std::clamp(body.age > 0 ? body.age : kAgeUnknown, 18.0, 70.0);
  const double air = body.sex == Sex::male ? 2.34 * stature + 0.009 * age - 1.09
                                           : 2.24 * stature + 0.001 * age - 1.00;  // litres
  return 1e-3 * std::max(air, 0.3) + kLungTissue;
}

// One ellipsoid a side within the box of the ribs.
void add_lungs(const Anatomy& anatomy, double volume, Piece& trunk) {
  Eigen::AlignedBox3d box;
  for (const Bone& bone : anatomy.bones)
    if (bone.name.starts_with("rib"))
      for (Eigen::Index v = 0; v < bone.mesh.V.rows(); ++v)
        box.extend(bone.mesh.V.row(v).transpose());
  if (box.isEmpty()) return;
  const Vec3 size = box.sizes();
  Vec3 radii(0.2 * size.x(), 0.4 * size.y(), 0.35 * size.z());
  radii *= std::cbrt(volume / 2 / ellipsoid_moments(Vec3::Zero(), Mat3::Identity(), radii).volume);
  for (const double side : {-1, 1})
    add_moments(ellipsoid_moments(box.center() + Vec3(side * 0.24 * size.x(), 0, 0),
                                  Mat3::Identity(), radii),
                1, trunk.lungs);
}

struct Tissues {
  double muscle_share = 0;  // of what is drawn as muscle; the rest is adipose
  double organs = kOrgans;  // kg/m^3, of the trunk's filling with its fat
  double fat = 0;           // m^3 of adipose, told
};

double filling_volume(const Piece& p) {
  return p.skin.volume - p.bones.volume - p.muscles.volume - p.lungs.volume -
         kSkinThickness * p.skin_area;
}

Tissues find_tissues(const Body& body, const std::vector<Piece>& pieces, double stature,
                     double mass) {
  double drawn = 0, limbs = 0, trunk = 0;
  for (const Piece& p : pieces) {
    drawn += p.muscles.volume;
    (p.filling == Filling::fat ? limbs : trunk) +=
        p.filling == Filling::brain ? 0 : std::max(0.0, filling_volume(p));
  }
  Tissues out;
  if (drawn > 0)
    out.muscle_share =
        std::min(1.0, muscle_mass(body.sex, body.age, stature, mass) / (kMuscleDensity * drawn));
  const double adipose = estimate_fat_share(body) * mass / (kFatInAdiposeTissue * kAdiposeDensity),
               in_trunk = std::clamp(adipose - limbs - (1 - out.muscle_share) * drawn, 0.0, trunk);
  if (trunk > 0) out.organs += (kAdiposeDensity - kOrgans) * in_trunk / trunk;
  out.fat = limbs + (1 - out.muscle_share) * drawn + in_trunk;
  return out;
}

BodySegment to_segment(const Piece& p, const Tissues& tissues, const Vec3& origin) {
  const double filling = p.filling == Filling::fat     ? kAdiposeDensity
                         : p.filling == Filling::brain ? kBrain
                                                       : tissues.organs;
  const double muscle =
      tissues.muscle_share * kMuscleDensity + (1 - tissues.muscle_share) * kAdiposeDensity;
  if (!(p.skin.volume > 0))
    throw UnfitError(
        fmt::format("segment '{}': a volume of {:.3g} l; the anatomy lacks its bones, or the skin "
                    "has no inside there (holes, or triangles turned inwards)",
                    p.name, 1e3 * p.skin.volume));
  SolidMoments sum;  // weighted by density: kg, kg m, kg m^2
  // the skin's own tissue lies where the piece has its mass, near enough
  const double skin = kSkinThickness * p.skin_area * (kSkin - filling) / p.skin.volume;
  add_moments(p.skin, filling + skin, sum);
  add_moments(p.bones, kBone - filling, sum);
  add_moments(p.muscles, muscle - filling, sum);
  add_moments(p.lungs, kLungs - filling, sum);
  if (!(sum.volume > 0))
    throw UnfitError(
        fmt::format("segment '{}': a mass of {:.3g} kg in {:.3g} l of skin; bones and "
                    "muscles overlap there",
                    p.name, sum.volume, 1e3 * p.skin.volume));
  return {p.name, p.joint, sum.volume, sum.first / sum.volume - origin, central_inertia(sum)};
}

}  // namespace

SegmentInertia segment_inertia(const Anatomy& anatomy, const Body& body,
                               std::span<const JointWeights> weights) {
  if (std::size_t(body.skin.V.rows()) != weights.size())
    throw std::invalid_argument("segment_inertia: a row of weights a vertex");
  if (body.skin.F.rows() == 0) throw UnfitError("inertia: the body has no skin to be cut");
  Cuts cuts(anatomy, body, weights);
  std::vector<Piece>& pieces = cuts.pieces();
  for (const Bone& bone : anatomy.bones)
    add_moments(solid_moments(bone.mesh), 1, pieces[cuts.piece_of(bone.joint)].bones);
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips)
      if (strip.slices.size() >= 2) add_muscle(strip, cuts, pieces);
  const double stature = body.skin.V.col(1).maxCoeff() - body.skin.V.col(1).minCoeff();
  for (Piece& piece : pieces)
    if (piece.name == "upper_trunk") add_lungs(anatomy, lung_volume(body, stature), piece);
  double volume = 0;
  for (const Piece& piece : pieces) volume += piece.skin.volume;
  if (!(volume > 0))
    throw UnfitError(
        fmt::format("inertia: the skin's volume is {:.3g} l; its triangles are turned "
                    "inwards, or it has holes",
                    1e3 * volume));
  constexpr double kWholeBody = 1010;  // kg/m^3, where the mass is not known
  const Tissues tissues =
      find_tissues(body, pieces, stature, body.mass > 0 ? body.mass : kWholeBody * volume);
  const std::vector<Vec3> rest = rest_positions(anatomy.skeleton);
  SegmentInertia out;
  for (const Piece& piece : pieces) {
    out.segments.push_back(to_segment(piece, tissues, rest[piece.joint]));
    out.volumes.push_back(piece.skin.volume);
    out.tissue_mass += out.segments.back().mass;
    out.bone_mass += kBone * piece.bones.volume;
    out.muscle_mass += tissues.muscle_share * kMuscleDensity * piece.muscles.volume;
    out.lung_mass += kLungs * piece.lungs.volume;
  }
  out.fat_mass = kAdiposeDensity * tissues.fat;
  out.mass = body.mass > 0 ? body.mass : out.tissue_mass;
  for (BodySegment& segment : out.segments) {
    segment.mass *= out.mass / out.tissue_mass;
    segment.inertia *= out.mass / out.tissue_mass;
  }
  return out;
}

BodySegment scaled_segment(const BodySegment& segment, const Vec3& factors) {
  const Mat3 second = 0.5 * segment.inertia.trace() * Mat3::Identity() - segment.inertia,
             scaled = factors.prod() * factors.asDiagonal() * second * factors.asDiagonal();
  return {segment.name, segment.joint, factors.prod() * segment.mass,
          factors.cwiseProduct(segment.center), scaled.trace() * Mat3::Identity() - scaled};
}

}  // namespace ecorche::inline v1
