#include "skinning/retarget/joint_names.h"

#include <array>
#include <cctype>
#include <set>
#include <vector>

namespace ecorche::inline v1 {
namespace {

struct Tokens {
  std::vector<std::string> words;    // lower case
  std::vector<std::string> numbers;  // as written
};

bool upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool lower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }
bool digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::string_view without_namespace(std::string_view name) {
  const size_t mark = name.find_last_of(":|");
  return mark == std::string_view::npos ? name : name.substr(mark + 1);
}

// "mixamorig:LeftUpLeg" -> left, up, leg; "index_02_l" -> index, l and 2; "LHipJoint" -> l, hip,
// joint.
Tokens split(std::string_view name) {
  name = without_namespace(name);
  Tokens out;
  std::string word;
  auto flush = [&] {
    if (!word.empty()) out.words.push_back(word);
    word.clear();
  };
  for (size_t k = 0; k < name.size(); ++k) {
    const char c = name[k];
    if (digit(c)) {
      flush();
      const size_t begin = k;
      while (k + 1 < name.size() && digit(name[k + 1])) ++k;
      out.numbers.emplace_back(name.substr(begin, k + 1 - begin));
    } else if (upper(c) || lower(c)) {
      const bool last_capital = upper(c) && k + 1 < name.size() && lower(name[k + 1]);
      // LUArm is left, upper arm
      const bool after_side = upper(c) && k == 1 && (name[0] == 'L' || name[0] == 'R') &&
                              name.size() > 3 && upper(name[2]) && lower(name[3]);
      const bool starts_word =
          after_side ||
          (upper(c) && k > 0 && (lower(name[k - 1]) || (upper(name[k - 1]) && last_capital)));
      if (starts_word) flush();
      word += char(std::tolower(static_cast<unsigned char>(c)));
    } else {
      flush();
    }
  }
  flush();
  return out;
}

bool one_of(const std::string& word, std::initializer_list<const char*> list) {
  for (const char* other : list)
    if (word == other) return true;
  return false;
}

std::string phalanx(int finger, int number) {
  static constexpr std::array<const char*, 3> kThumb = {"cmc1", "mcp1", "ip1"},
                                              kFinger = {"mcp", "pip", "dip"};
  if (number < 1 || number > 3) return "";
  return finger == 1 ? kThumb[number - 1] : kFinger[number - 1] + std::to_string(finger);
}

std::string toe_joint(int toe, int number) {
  static constexpr std::array<const char*, 3> kToe = {"mtp", "toe_pip", "toe_dip"};
  if (toe < 1 || toe > 5 || number < 1 || number > (toe == 1 ? 2 : 3)) return "";
  if (toe == 1 && number == 2) return "toe_ip1";
  return kToe[number - 1] + std::to_string(toe);
}

int value(const std::string& number) { return number.size() > 5 ? -1 : std::stoi(number); }

// The bone of a finger from the palm on that a word names, 0 for none. A thumb's first bone is its
// metacarpal.
int named_bone(const std::string& joined, bool thumb) {
  if (joined.ends_with("metacarpal")) return thumb ? 1 : 0;
  if (joined.ends_with("proximal")) return thumb ? 2 : 1;
  if (joined.ends_with("intermediate") || joined.ends_with("medial")) return 2;
  return joined.ends_with("distal") ? 3 : 0;
}

std::string finger_part(const std::string& joined, const std::vector<std::string>& numbers) {
  static constexpr std::array<std::pair<const char*, int>, 7> kFingers = {{{"thumb", 1},
                                                                           {"index", 2},
                                                                           {"middle", 3},
                                                                           {"mid", 3},
                                                                           {"ring", 4},
                                                                           {"pinky", 5},
                                                                           {"little", 5}}};
  for (const auto& [word, finger] : kFingers)
    if (joined.find(word) != std::string::npos) {
      const int bone = named_bone(joined, finger == 1);
      return phalanx(finger, bone > 0          ? bone
                             : numbers.empty() ? (finger == 1 ? 1 : 0)
                                               : value(numbers.back()));
    }
  if (joined.find("finger") == std::string::npos) return "";
  if (numbers.size() == 2) return phalanx(value(numbers[0]), value(numbers[1]));  // finger2-1
  if (joined == "fingerbase") return "wrist";
  if (numbers.empty()) return "fingers";
  if (numbers.size() > 1) return "";
  if (const int bone = named_bone(joined, value(numbers[0]) == 1); bone > 0)  // Finger2Proximal
    return phalanx(value(numbers[0]), bone);
  // Biped counts fingers from 0, and their further bones in a second digit: Finger1, Finger11.
  const std::string& number = numbers[0];
  if (joined != "finger" || number.size() > 2) return "fingers";
  return phalanx(number[0] - '0' + 1, number.size() == 1 ? 1 : number[1] - '0' + 1);
}

std::string sided_part(const std::string& joined) {
  if (one_of(joined,
             {"leg", "lowleg", "lowerleg", "leglower", "shin", "calf", "knee", "tibia", "shank"}))
    return "knee";
  if (joined == "ankle") return "ankle";
  if (joined == "foot") return "foot?";
  if (one_of(joined, {"toe", "toes", "toebase", "ball", "forefoot", "forefeet"})) return "toes";
  if (one_of(joined, {"upleg", "upperleg", "legupper", "thigh", "femur"})) return "hip";
  if (joined == "hip") return "hip?";
  if (one_of(joined, {"forearm", "lowerarm", "lowarm", "armlower", "farm", "elbow", "radius"}))
    return "elbow";
  if (one_of(joined, {"hand", "wrist"})) return "wrist";
  if (one_of(joined, {"arm", "upperarm", "uparm", "uarm", "armupper", "shldr", "humerus"}))
    return "shoulder";
  if (joined == "shoulder") return "shoulder?";
  if (one_of(joined, {"clavicle", "collar", "clav", "collarbone"})) return "clavicle";
  if (joined == "scapula") return "scapula";
  return "";
}

Side side_of_word(const std::string& word) {
  if (one_of(word, {"left", "l", "lft", "lf"})) return Side::left;
  if (one_of(word, {"right", "r", "rgt", "rt"})) return Side::right;
  return Side::middle;
}

}  // namespace

NamedPart named_part(std::string_view joint_name) {
  Tokens tokens = split(joint_name);
  NamedPart out;
  std::string joined;
  bool joint = false;
  for (const std::string& word : tokens.words) {
    if (one_of(word, {"end", "nub", "site", "top", "twist", "roll", "part", "share", "in", "ik",
                      "pole", "prop"}))
      return out;
    joint |= word == "joint";
    if (const Side side = side_of_word(word); side != Side::middle && out.side == Side::middle)
      out.side = side;
    else if (!one_of(word, {"mixamorig", "bip", "bone", "jnt", "joint", "def", "bend", "stretch",
                            "c", "m", "x"}))
      joined += word;
  }
  if (joint && joined == "hip" && out.side != Side::middle) return out;  // before the hip: CMU's
  if (out.side == Side::middle) {
    if (one_of(joined, {"head", "skull"}))
      out.part = "head";
    else if (one_of(joined, {"jaw", "mandible"}))
      out.part = "jaw";
    else if (one_of(joined, {"hips", "hip", "pelvis"}))
      out.part = "pelvis";
    else if (joined.size() > 2 &&
             (joined[0] == 'l' ||
              joined[0] == 'r')) {  // "lhand": the side without a capital after it
      out.side = joined[0] == 'l' ? Side::left : Side::right;
      joined.erase(0, 1);
    }
    if (out.side == Side::middle) return out;
  }
  if (joined.starts_with("toe") && tokens.numbers.size() == 2)
    out.part = toe_joint(value(tokens.numbers[0]), value(tokens.numbers[1]));
  else if (out.part = sided_part(joined); out.part.empty())
    out.part = finger_part(joined, tokens.numbers);
  if (out.part.empty()) out.side = Side::middle;
  return out;
}

namespace {

// What three quarters of the joints begin with, up to a word's end, and that names no side or part.
std::string common_prefix(std::span<const std::string> joint_names) {
  constexpr size_t kFewest = 10;  // joints
  if (joint_names.size() < kFewest) return "";
  // Does a word begin at `at`?
  const auto begins_word = [](std::string_view name, size_t at) {
    const char before = name[at - 1], here = name[at];
    return (upper(here) && !upper(before)) || (!lower(before) && !upper(before) && !digit(before));
  };
  const auto shared = [&](std::string_view prefix) {
    size_t count = 0;
    for (const std::string& name : joint_names)
      count += without_namespace(name).starts_with(prefix);
    return 4 * count >= 3 * joint_names.size();
  };
  std::string out;
  for (const std::string& name : joint_names) {
    const std::string_view mine = without_namespace(name);
    for (size_t at = 1; at < mine.size(); ++at) {
      const std::string_view prefix = mine.substr(0, at);
      if (at <= out.size() || !begins_word(mine, at) || !shared(prefix)) continue;
      const Tokens tokens = split(prefix);
      bool sided = false;
      for (const std::string& word : tokens.words) sided |= side_of_word(word) != Side::middle;
      if (!sided && named_part(prefix).part.empty()) out = prefix;
    }
  }
  return out;
}

}  // namespace

std::vector<NamedPart> named_parts(std::span<const std::string> joint_names) {
  const std::string prefix = common_prefix(joint_names);
  std::vector<NamedPart> out;
  for (const std::string& name : joint_names) {
    std::string_view own = without_namespace(name);
    if (own.starts_with(prefix)) own.remove_prefix(prefix.size());
    out.push_back(named_part(own));
  }
  return out;
}

}  // namespace ecorche::inline v1
