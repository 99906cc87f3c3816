#include "skinning/retarget/joint_mapping.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <string_view>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "skinning/retarget/joint_names.h"

namespace ecorche::inline v1 {
namespace {

// per file joint: "elbow_l", "hip?_l", "toes_r", "head" or ""
using Parts = std::vector<std::string>;

std::vector<int> path_up(const MotionClip& source, int joint) {  // the joint itself first
  std::vector<int> path;
  for (; joint >= 0; joint = source.joints[joint].parent) path.push_back(joint);
  return path;
}

int common_ancestor(const MotionClip& source, int a, int b) {
  const std::vector<int> above = path_up(source, a);
  for (int j : path_up(source, b))
    if (std::find(above.begin(), above.end(), j) != above.end()) return j;
  return -1;
}

// Joints from `joint`'s parent up to, but without, `stop`.
std::vector<int> between(const MotionClip& source, int joint, int stop) {
  std::vector<int> path;
  for (int j = source.joints[joint].parent; j >= 0 && j != stop; j = source.joints[j].parent)
    path.push_back(j);
  return path;
}

int first_with(const Parts& parts, const std::string& part) {
  const auto found = std::find(parts.begin(), parts.end(), part);
  return found == parts.end() ? -1 : int(found - parts.begin());
}

// Whether a name can be that of a joint beside those of data/joints.csv, which other files may have
// as something else.
bool is_own(const std::string& name) {
  std::string stem = name.substr(0, name.find_last_not_of("0123456789") + 1);
  if (name.ends_with("_l") || name.ends_with("_r")) {
    stem = name.substr(0, name.size() - 2);
    stem.resize(stem.find_last_not_of("0123456789") + 1);
  }
  static const std::set<std::string> kBuiltIn{
      "pelvis",   "l",        "t",        "thorax", "c",       "head",    "jaw",
      "clavicle", "scapula",  "shoulder", "elbow",  "forearm", "wrist",   "cmc",
      "mcp",      "ip",       "pip",      "dip",    "hip",     "patella", "knee",
      "ankle",    "subtalar", "mtp",      "toe_ip", "toe_pip", "toe_dip"};
  return !stem.empty() && !kBuiltIn.contains(stem);
}

class JointMapper {
 public:
  JointMapper(const MotionClip& source, JointMapping& mapping)
      : source_(source), mapping_(mapping), parts_(source.joints.size()) {}

  void name_parts(const std::map<std::string, std::string>& joint_map, const Skeleton& ours) {
    how_.assign(parts_.size(), "name");
    std::vector<std::string> names;
    for (const ClipJoint& joint : source_.joints) names.push_back(joint.name);
    const std::vector<NamedPart> named = named_parts(names);
    std::set<std::string> unused;
    for (const auto& [file_joint, our_joint] : joint_map) unused.insert(file_joint);
    for (size_t j = 0; j < parts_.size(); ++j) {
      const std::string& name = source_.joints[j].name;
      if (const auto mapped = joint_map.find(name); mapped != joint_map.end()) {
        if (!mapped->second.empty() && find_joint(ours, mapped->second) < 0 &&
            !mapped->second.starts_with("toes_"))
          throw UnfitError(fmt::format(
              "joint map: '{} = {}': we have no joint '{}'; `ecorche list joints` names ours",
              printable(name), printable(mapped->second), printable(mapped->second)));
        parts_[j] = mapped->second;
        how_[j] = "map";
        if (is_own(mapped->second)) own_.push_back(int(j));
        unused.erase(name);
      } else if (mapping_.ours) {
        parts_[j] = find_joint(ours, name) >= 0 ? name : "";
      } else if (!named[j].part.empty()) {
        parts_[j] = named[j].part + side_suffix(named[j].side);
      } else if (is_own(name) && find_joint(ours, name) >= 0) {
        parts_[j] = name;
        own_.push_back(int(j));
      }
    }
    for (const std::string& name : unused)
      mapping_.warnings.push_back(
          fmt::format("joint map: the file has no joint '{}'", printable(name)));
  }

  // Joints of the character that the file has by the same name, beside those of a figure.
  void take_own() {
    for (const int j : own_)
      if (get(parts_[std::size_t(j)]) < 0) set(parts_[std::size_t(j)], j, j);
  }

  // Joints that only the tree can tell, once the names have given elbows, knees and head.
  void complete() {
    if (mapping_.ours) {
      for (size_t j = 0; j < parts_.size(); ++j)
        if (!parts_[j].empty()) set(parts_[j], int(j), int(j));
      return;
    }
    take_own();
    for (const char* side : {"_l", "_r"}) {
      feet_and_hands(side);
      for (const char* part : {"knee", "ankle", "elbow", "wrist"}) runs(std::string(part) + side);
    }
    if (int head = first_with(parts_, "head"); head >= 0) set("head", head, head);
    if (get("head") < 0)
      if (const int neck = last_neck(); neck >= 0) set("head", neck, neck);
    if (int jaw = first_with(parts_, "jaw"); jaw >= 0) set("jaw", jaw, jaw);
    if (get("head") < 0)
      if (const int top = top_of_chest(); top >= 0) set("head", top, top);
    trunk();
    for (const std::string side : {"_l", "_r"}) {
      if (mapping_.position_joint.count("elbow" + side) &&
          mapping_.rotation_joint["elbow" + side] != mapping_.position_joint["elbow" + side]) {
        // Two forearm bones: the first is the ulna, the second rotates with the hand.
        set("forearm" + side, mapping_.rotation_joint["elbow" + side],
            mapping_.rotation_joint["elbow" + side]);
        mapping_.rotation_joint["elbow" + side] = mapping_.position_joint["elbow" + side];
      }
      limb_root("hip", "knee", side, "pelvis");
      limb_root("shoulder", "elbow", side, "thorax");
      girdle(side);
      digits(side);
    }
  }

  void write_matches() {
    std::map<int, std::string> names;
    for (const auto& [ours, joint] : mapping_.position_joint) names[joint] = ours;
    for (const auto& [ours, joint] : mapping_.rotation_joint)
      names[joint] = names.count(joint) && names[joint] != ours ? names[joint] + ", " + ours : ours;
    for (int j : mapping_.spine) names.try_emplace(j, "spine");
    for (int j : mapping_.neck) names.try_emplace(j, "neck");
    for (size_t j = 0; j < parts_.size(); ++j) {
      const auto found = names.find(int(j));
      const bool used = found != names.end();
      const bool named = !parts_[j].empty() && parts_[j].find('?') == std::string::npos;
      mapping_.matches.push_back({source_.joints[j].name, used ? found->second : "",
                                  !used   ? ""
                                  : named ? how_[j]
                                          : "tree"});
    }
  }

  std::vector<std::string> missing() const {
    std::vector<std::string> out;
    for (const char* part : {"pelvis", "thorax", "head"})
      if (!mapping_.position_joint.count(part)) out.push_back(part);
    for (const char* part : {"shoulder", "elbow", "hip", "knee", "ankle"})
      for (const char* side : {"_l", "_r"})
        if (!mapping_.position_joint.count(std::string(part) + side))
          out.push_back(std::string(part) + side);
    return out;
  }

 private:
  void set(const std::string& ours, int position_joint, int rotation_joint) {
    mapping_.position_joint[ours] = position_joint;
    mapping_.rotation_joint[ours] = rotation_joint;
  }

  // Of a figure without a joint for the head: the neck, where it ends the figure and so carries it.
  int last_neck() const {
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      std::string name = source_.joints[j].name;
      std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
      const bool carries = std::ranges::any_of(
          source_.joints, [&](const ClipJoint& other) { return other.parent == int(j); });
      if (!carries && name.find("neck") != std::string::npos) return int(j);
    }
    return -1;
  }

  int get(const std::string& ours) const {
    const auto found = mapping_.position_joint.find(ours);
    return found == mapping_.position_joint.end() ? -1 : found->second;
  }

  // Of a figure with no name for the head: the end of the chain that rises between its arms.
  int top_of_chest() const {
    if (get("elbow_l") < 0 || get("elbow_r") < 0) return -1;
    const int chest = common_ancestor(source_, get("elbow_l"), get("elbow_r"));
    const auto children = [&](int joint) {
      std::vector<int> out;
      for (size_t j = 0; j < source_.joints.size(); ++j)
        if (source_.joints[j].parent == joint) out.push_back(int(j));
      return out;
    };
    const auto leads_to_arm = [&](int joint) {
      return std::ranges::any_of(std::array{"elbow_l", "elbow_r"}, [&](const char* elbow) {
        return std::ranges::count(path_up(source_, get(elbow)), joint) > 0;
      });
    };
    int top = -1;
    std::size_t longest = 1;  // a single joint is no neck with a head
    for (const int child : children(chest)) {
      if (chest < 0 || leads_to_arm(child)) continue;
      std::vector<int> chain{child};
      for (std::vector<int> next = children(child); next.size() == 1; next = children(next[0]))
        chain.push_back(next[0]);
      if (chain.size() > longest) longest = chain.size(), top = chain.back();
    }
    return top;
  }

  // A foot beyond an ankle is its toes, unless toes follow; a hand beyond a wrist is its fingers,
  // unless fingers do.
  void feet_and_hands(const std::string& side) {
    const auto above = [&](int joint, std::string_view part) {
      for (const int j : path_up(source_, source_.joints[joint].parent))
        if (parts_[j] == part) return true;
      return false;
    };
    const auto carries = [&](int joint, const auto& beyond) {
      for (size_t j = 0; j < parts_.size(); ++j)
        if (parts_[j].ends_with(side) && beyond(parts_[j]) &&
            common_ancestor(source_, joint, int(j)) == joint && joint != int(j))
          return true;
      return false;
    };
    const auto is_toe = [](std::string_view part) {
      return part.starts_with("toe") || part.starts_with("mtp");
    };
    const auto is_finger = [](std::string_view part) {
      return part.find("mcp") != part.npos || part.find("pip") != part.npos ||
             part.starts_with("fingers");
    };
    const std::string foot = "foot?" + side, ankle = "ankle" + side, wrist = "wrist" + side;
    for (size_t j = 0; j < parts_.size(); ++j) {
      if (parts_[j] == foot)
        parts_[j] = above(int(j), ankle) && !carries(int(j), is_toe) ? "toes" + side : ankle;
      else if (parts_[j] == wrist && above(int(j), wrist) && !carries(int(j), is_finger))
        parts_[j] = "fingers" + side;
    }
  }

  // A part that the file splits into a chain of joints (lowerarm01, lowerarm02): the first has the
  // position, the last the rotation.
  void runs(const std::string& part) {
    const int first = first_with(parts_, part);
    if (first < 0) return;
    int last = first;
    for (size_t j = first + 1; j < parts_.size(); ++j)
      if (parts_[j] == part && source_.joints[j].parent == last) last = int(j);
    set(part, first, last);
  }

  void trunk() {
    if (get("knee_l") >= 0 && get("knee_r") >= 0) {
      const int pelvis = common_ancestor(source_, get("knee_l"), get("knee_r"));
      if (pelvis >= 0) set("pelvis", pelvis, pelvis);
    }
    if (get("elbow_l") >= 0 && get("elbow_r") >= 0) {
      const int chest = common_ancestor(source_, get("elbow_l"), get("elbow_r"));
      if (chest >= 0) set("thorax", chest, chest);
    }
    if (get("pelvis") < 0 || get("thorax") < 0) return;
    const int below = common_ancestor(source_, get("pelvis"), get("thorax"));
    if (get("thorax") != below) mapping_.spine = between(source_, get("thorax"), below);
    std::reverse(mapping_.spine.begin(), mapping_.spine.end());
    if (get("head") < 0) return;
    mapping_.neck =
        between(source_, get("head"), common_ancestor(source_, get("thorax"), get("head")));
    std::reverse(mapping_.neck.begin(), mapping_.neck.end());
  }

  // The thigh over the knee, the upper arm over the elbow.
  void limb_root(const std::string& root, const std::string& middle, const std::string& side,
                 const std::string& stop) {
    const int joint = get(middle + side), end = get(stop);
    if (joint < 0 || end < 0) return;
    const std::vector<int> path = between(source_, joint, end);
    int first = -1, last = -1;
    for (int j : path)
      if (parts_[j] == root + side) {
        first = j;
        if (last < 0) last = j;
      }
    for (size_t k = 0; first < 0 && k < path.size(); ++k)
      if (parts_[path[k]] == root + "?" + side) first = last = path[k];
    if (first < 0 && !path.empty()) first = last = path.front();
    if (first >= 0) set(root + side, first, last);
  }

  void girdle(const std::string& side) {
    const int shoulder = get("shoulder" + side), chest = get("thorax");
    if (shoulder < 0 || chest < 0) return;
    std::vector<int> path;  // from the chest outwards
    for (int j : between(source_, shoulder, chest))
      if (parts_[j] == "clavicle" + side || parts_[j] == "scapula" + side ||
          parts_[j] == "shoulder?" + side)
        path.insert(path.begin(), j);
    if (!path.empty()) set("clavicle" + side, path[0], path[0]);
    if (path.size() < 2) return;
    set("scapula" + side, path.back(), path.back());
    if (parts_[path.back()] != "scapula" + side) mapping_.outer_collars.insert("scapula" + side);
  }

  void digits(const std::string& side) {
    for (size_t j = 0; j < parts_.size(); ++j) {
      std::string part = parts_[j];
      if (!part.ends_with(side)) continue;
      part.resize(part.size() - side.size());
      const bool finger = part.starts_with("cmc") || part.starts_with("mcp") ||
                          part.starts_with("ip") || part.starts_with("pip") ||
                          part.starts_with("dip") || part == "fingers";
      const bool toe = part.starts_with("mtp") || part.starts_with("toe");
      const int limb = get((finger ? "wrist" : "ankle") + side);
      if ((finger || toe) && limb >= 0 && common_ancestor(source_, limb, int(j)) == limb &&
          get(parts_[j]) < 0)
        set(parts_[j], int(j), int(j));
    }
    // One finger alone stands for all four.
    if (get("mcp2" + side) >= 0 && get("mcp3" + side) < 0 && get("pip2" + side) < 0) {
      set("fingers" + side, get("mcp2" + side), get("mcp2" + side));
      mapping_.position_joint.erase("mcp2" + side);
      mapping_.rotation_joint.erase("mcp2" + side);
    }
  }

  const MotionClip& source_;
  JointMapping& mapping_;
  Parts parts_;
  std::vector<std::string> how_;
  std::vector<int> own_;  // joints of the file that are a character's own: a tail, a wing
};

bool has_our_names(const MotionClip& source, const Skeleton& ours) {
  std::set<std::string> names;
  for (const ClipJoint& joint : source.joints) names.insert(joint.name);
  size_t found = 0;
  for (const Joint& joint : ours.joints) found += names.count(joint.name);
  return 10 * found >= 9 * ours.joints.size();
}

}  // namespace

bool bone_end(const MotionClip& source, int joint, Vec3& offset) {
  offset.setZero();
  if (!source.joints[joint].end_sites.empty()) {
    offset = source.joints[joint].end_sites[0];
  } else {
    int children = 0;
    for (const ClipJoint& other : source.joints)
      if (other.parent == joint) offset += other.offset, ++children;
    if (children > 0) offset /= children;
  }
  return offset.norm() > 0;
}

JointMapping map_joints(const MotionClip& source, const Skeleton& ours,
                        const std::map<std::string, std::string>& joint_map) {
  JointMapping mapping;
  mapping.ours = has_our_names(source, ours);
  JointMapper mapper(source, mapping);
  mapper.name_parts(joint_map, ours);
  mapper.complete();
  mapper.write_matches();
  if (const auto missing = mapper.missing(); !missing.empty()) {
    throw UnfitError(fmt::format(
        "{}: no joint found for {}; name them in a joint map (file joint = our joint)\n{}{}{}",
        source.name, fmt::join(missing, ", "), fmt::join(mapping.warnings, "\n"),
        mapping.warnings.empty() ? "" : "\n", format_matches(mapping.matches)));
  }
  return mapping;
}

std::string format_matches(const std::vector<JointMatch>& matches) {
  size_t width = 4;
  for (const JointMatch& match : matches) width = std::max(width, match.source.size());
  std::string out = fmt::format("{:{}}  {:24}  how\n", "file", width, "ours");
  for (const JointMatch& match : matches)
    out += fmt::format("{:{}}  {:24}  {}\n", match.source, width,
                       match.ours.empty() ? "-" : match.ours, match.how);
  return out;
}

}  // namespace ecorche::inline v1
