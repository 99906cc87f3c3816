#include "skinning/retarget/joint_names.h"

#include <array>
#include <cctype>
#include <set>
#include <vector>

namespace ecorche::inline v1 {
namespace {

struct Tokens {
  std::vector<std::string> words;  // lower case
  std::vector<int> numbers;
};

bool upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool lower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }
bool digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// "mixamorig:LeftUpLeg" -> left, up, leg; "index_02_l" -> index, l and 2; "LHipJoint" -> l, hip,
// joint.
Tokens split(std::string_view name) {
  if (const size_t prefix = name.find_last_of(":|"); prefix != std::string_view::npos)
    name.remove_prefix(prefix + 1);
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
      int number = 0;
      while (k < name.size() && digit(name[k]) && number < 100000)
        number = 10 * number + (name[k++] - '0');
      --k;
      out.numbers.push_back(number);
    } else if (upper(c) || lower(c)) {
      const bool starts_word =
          upper(c) && k > 0 &&
          (lower(name[k - 1]) || (upper(name[k - 1]) && k + 1 < name.size() && lower(name[k + 1])));
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

std::string finger_part(const std::string& joined, const std::vector<int>& numbers) {
  static constexpr std::array<std::pair<const char*, int>, 7> kFingers = {{{"thumb", 1},
                                                                           {"index", 2},
                                                                           {"middle", 3},
                                                                           {"mid", 3},
                                                                           {"ring", 4},
                                                                           {"pinky", 5},
                                                                           {"little", 5}}};
  for (const auto& [word, finger] : kFingers)
    if (joined.find(word) != std::string::npos)
      return phalanx(finger, numbers.empty() ? (finger == 1 ? 1 : 0) : numbers.back());
  if (joined.find("finger") == std::string::npos) return "";
  if (numbers.size() == 2) return phalanx(numbers[0], numbers[1]);  // finger2-1
  if (joined == "fingerbase") return "wrist";
  return numbers.size() <= 1 ? "fingers" : "";
}

std::string sided_part(const std::string& joined) {
  if (one_of(joined,
             {"leg", "lowleg", "lowerleg", "leglower", "shin", "calf", "knee", "tibia", "shank"}))
    return "knee";
  if (one_of(joined, {"foot", "ankle"})) return "ankle";
  if (one_of(joined, {"toe", "toes", "toebase", "ball", "forefoot", "forefeet"})) return "toes";
  if (one_of(joined, {"upleg", "upperleg", "legupper", "thigh", "femur"})) return "hip";
  if (joined == "hip") return "hip?";
  if (one_of(joined, {"forearm", "lowerarm", "lowarm", "armlower", "elbow", "radius"}))
    return "elbow";
  if (one_of(joined, {"hand", "wrist"})) return "wrist";
  if (one_of(joined, {"arm", "upperarm", "uparm", "armupper", "shldr", "humerus"}))
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
  for (const std::string& word : tokens.words) {
    if (one_of(word, {"end", "nub", "site", "top", "twist", "roll", "metacarpal", "in"}))
      return out;
    if (const Side side = side_of_word(word); side != Side::middle && out.side == Side::middle)
      out.side = side;
    else if (!one_of(word, {"mixamorig", "bip", "bone", "jnt", "def"}))
      joined += word;
  }
  if (joined == "hipjoint") return out;
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
    out.part = toe_joint(tokens.numbers[0], tokens.numbers[1]);
  else if (out.part = sided_part(joined); out.part.empty())
    out.part = finger_part(joined, tokens.numbers);
  if (out.part.empty()) out.side = Side::middle;
  return out;
}

}  // namespace ecorche::inline v1
