#include "morph/registration/body_proportions.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <optional>

namespace ecorche::inline v1 {
namespace {

constexpr double kUnusual = 1.6;  // times the mean person's; adults' spread stays within 1.25

// Where joints are: of the mean body, or of a file that names some.
using JointPlaces = std::map<std::string, Vec3>;

JointPlaces mean_places(const ArticulatedBody& body) {
  JointPlaces out;
  for (std::size_t j = 0; j < body.joints.size(); ++j)
    out[body.joints[j].name] = body.joint_mean.row(Eigen::Index(j));
  return out;
}

JointPlaces named_places(const ArticulatedBody& body, const std::vector<PlaceHint>& hints) {
  JointPlaces out;
  for (const PlaceHint& hint : hints)
    if (hint.joint >= 0) out[body.joints[std::size_t(hint.joint)].name] = hint.place;
  return out;
}

bool has(const JointPlaces& places, std::initializer_list<const char*> names) {
  return std::all_of(names.begin(), names.end(),
                     [&](const char* name) { return places.contains(name); });
}

// Between joints one after the other, both sides together.
std::optional<double> limb_length(const JointPlaces& places,
                                  std::initializer_list<const char*> joints) {
  double length = 0;
  for (const char* side : {"_l", "_r"}) {
    const Vec3* last = nullptr;
    for (const char* joint : joints) {
      const auto here = places.find(std::string(joint) + side);
      if (here == places.end()) return std::nullopt;
      if (last) length += (here->second - *last).norm();
      last = &here->second;
    }
  }
  return length / 2;
}

struct Lengths {
  double trunk = 0;  // from between the hips to the head's joint, m
  std::optional<double> head, arms, legs;
};

std::optional<Lengths> lengths_of(const JointPlaces& places, const Points& points) {
  if (!has(places, {"thigh_l", "thigh_r", "head"})) return std::nullopt;
  const Vec3 head = places.at("head");
  const Vec3 trunk = head - 0.5 * (places.at("thigh_l") + places.at("thigh_r"));
  Lengths out;
  out.trunk = trunk.norm();
  if (out.trunk <= 0) return std::nullopt;
  out.head = ((points.rowwise() - head.transpose()) * (trunk / out.trunk)).maxCoeff();
  out.arms = limb_length(places, {"arm", "forearm", "hand"});
  out.legs = limb_length(places, {"thigh", "shank", "foot"});
  return out;
}

}  // namespace

std::vector<std::string> unusual_proportions(const ArticulatedBody& body, const Scan& scan,
                                             const std::vector<PlaceHint>& hints) {
  const std::optional<Lengths> theirs = lengths_of(named_places(body, hints), scan.points),
                               usual = lengths_of(mean_places(body), body.mean);
  std::vector<std::string> out;
  if (!theirs || !usual) return out;
  const auto compare = [&](const char* part, const std::optional<double>& length,
                           const std::optional<double>& mean) {
    if (!length || !mean) return;
    const double ratio = *length / theirs->trunk / (*mean / usual->trunk);
    if (ratio > kUnusual || ratio < 1 / kUnusual)
      out.push_back(fmt::format("{} {:.1f} times as long", part, ratio));
  };
  compare("the head is", theirs->head, usual->head);
  compare("arms are", theirs->arms, usual->arms);
  compare("legs are", theirs->legs, usual->legs);
  return out;
}

}  // namespace ecorche::inline v1
