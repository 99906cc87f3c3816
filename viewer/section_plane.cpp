#include "viewer/section_plane.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "anatomy/errors.h"
#include "anatomy/files/quantity.h"
#include "viewer/part_names.h"

namespace ecorche {
namespace {

constexpr double kFarthest = 10;  // m

using Kind = SectionPlane::Kind;

Kind kind_named(const std::string& name) {
  return name == "transverse" ? Kind::transverse
         : name == "frontal"  ? Kind::frontal
         : name == "sagittal" ? Kind::sagittal
                              : Kind::none;
}

// "-2cm": quantities have no sign of their own.
double signed_length(const std::string& text, const std::string& where) {
  const bool below = text.starts_with('-');
  const double length = parse_length(text.substr(below ? 1 : 0), where, {0, kFarthest},
                                     {kFarthest, kFarthest});  // metres where no unit is said
  return below ? -length : length;
}

// "50%" or "0.5".
double share_of(std::string text, const std::string& where) {
  double share = 0;
  const bool percent = text.ends_with('%');
  if (percent) text.pop_back();
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), share);
  if (percent) share /= 100;
  if (error != std::errc() || end != text.data() + text.size() || !(share >= 0 && share <= 1))
    throw UsageError(fmt::format("{}: '{}': expected a share of the way, 0% .. 100%", where, text));
  return share;
}

std::string checked_joint(const std::string& name, const Skeleton& skeleton,
                          const std::string& where) {
  if (find_joint(skeleton, name) >= 0) return name;
  std::vector<std::string> names;
  for (const Joint& joint : skeleton.joints) names.push_back(joint.name);
  const std::string near = nearest_name(name, names);
  throw UsageError(fmt::format("{}: '{}' is no joint{}", where, name,
                               near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

Vec3 place_of_joint(const std::string& name, const Skeleton& skeleton, const PosedAnatomy& posed) {
  return posed.X_WJ[std::size_t(find_joint(skeleton, name))].translation();
}

}  // namespace

SectionPlane read_section_plane(const std::string& text, const Skeleton& skeleton,
                                const std::string& where) {
  const auto colon = text.find(':');
  const std::string plane = text.substr(0, colon);
  const std::string place = colon == std::string::npos ? "" : text.substr(colon + 1);
  SectionPlane out;
  out.kind = kind_named(plane);
  const auto dash = plane.find('-');
  if (place.empty() || (out.kind == Kind::none && dash == std::string::npos))
    throw UsageError(
        fmt::format("{}: '{}': expected transverse:HEIGHT, frontal:BEFORE, sagittal:LEFT, or "
                    "JOINT-JOINT:SHARE, for example transverse:95cm or hip_l-knee_l:50%",
                    where, text));
  if (out.kind != Kind::none) {
    out.place = signed_length(place, where);
    return out;
  }
  out.kind = Kind::across;
  out.from = checked_joint(plane.substr(0, dash), skeleton, where);
  out.to = checked_joint(plane.substr(dash + 1), skeleton, where);
  out.share = share_of(place, where);
  const std::vector<Vec3> rest = rest_positions(skeleton);
  if (out.from == out.to || (rest[std::size_t(find_joint(skeleton, out.from))] -
                             rest[std::size_t(find_joint(skeleton, out.to))])
                                    .norm() < 1e-3)
    throw UsageError(fmt::format("{}: '{}': the joints lie in one place; name two", where, text));
  return out;
}

Vec4f plane_of(const SectionPlane& section, const Skeleton& skeleton, const PosedAnatomy& posed) {
  const Vec3 root = posed.X_WJ.front().translation();
  Vec3 normal = Vec3::UnitY(), at(0, section.place, 0);
  if (section.kind == Kind::frontal) {
    normal = Vec3::UnitZ();
    at = root + section.place * normal;
  } else if (section.kind == Kind::sagittal) {
    normal = Vec3::UnitX();
    at = root + section.place * normal;
  } else if (section.kind == Kind::across) {
    const Vec3 from = place_of_joint(section.from, skeleton, posed),
               to = place_of_joint(section.to, skeleton, posed);
    normal = (to - from).normalized();
    at = (1 - section.share) * from + section.share * to;
  }
  Vec4f out;
  out << normal.cast<float>(), float(normal.dot(at));
  return out;
}

}  // namespace ecorche
