#include "morph/registration/scan_parts.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <vector>

namespace ecorche::inline v1 {
namespace {

constexpr std::array kCoverings{
    "cloth",  "clothes", "clothing", "shirt",   "tshirt",  "shoe",    "boot",    "sock",
    "jacket", "coat",    "vest",     "pant",    "trouser", "jeans",   "short",   "skirt",
    "dress",  "robe",    "suit",     "armor",   "armour",  "helmet",  "hat",     "cap",
    "hood",   "glove",   "gauntlet", "cape",    "cloak",   "scarf",   "belt",    "underwear",
    "bra",    "brief",   "boxer",    "bikini",  "sweater", "hoodie",  "garment", "outfit",
    "sandal", "sneaker", "stocking", "tight",   "legging", "uniform", "costume", "blouse",
    "mask",   "greave",  "cuirass",  "pauldron"};
constexpr std::array kOthers{
    "hair",       "eye",      "eyeball",  "eyelash", "lash",   "eyebrow",  "brow",       "cornea",
    "iris",       "teeth",    "tooth",    "tongue",  "gum",    "beard",    "mustache",   "tear",
    "prop",       "weapon",   "sword",    "shield",  "gun",    "rifle",    "pistol",     "bow",
    "arrow",      "staff",    "axe",      "spear",   "knife",  "bag",      "backpack",   "glasses",
    "earring",    "jewelry",  "necklace", "floor",   "ground", "pedestal", "base_plate", "plinth",
    "background", "wall",     "camera",   "light",   "horn",   "tail",     "wing",       "quiver",
    "scabbard",   "collider", "icosphere"};

// "HeroShirt_001" -> hero, shirt
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> out;
  std::string word;
  char last = 0;
  for (const char c : name) {
    const bool letter = std::isalpha(int((unsigned char)(c))) != 0;
    const bool hump = letter && std::isupper(int((unsigned char)(c))) != 0 &&
                      std::islower(int((unsigned char)(last))) != 0;
    if ((!letter || hump) && !word.empty()) out.push_back(std::move(word)), word.clear();
    if (letter) word += char(std::tolower(int((unsigned char)(c))));
    last = c;
  }
  if (!word.empty()) out.push_back(std::move(word));
  return out;
}

bool is_word(const std::string& word, std::string_view key) {
  if (word == key) return true;
  if (word.size() == key.size() + 1 && word.back() == 's' && word.starts_with(key)) return true;
  // joined words, of keys long enough not to stand inside others by chance
  constexpr std::size_t kLong = 5;
  return key.size() >= kLong && word.find(key) != std::string::npos;
}

std::optional<PartKind> kind_of_name(std::string_view name) {
  std::optional<PartKind> kind;
  for (const std::string& word : words_of(name)) {
    if (word == "body" || word == "skin" || word == "head") return PartKind::body;
    const auto names = [&word](const char* key) { return is_word(word, key); };
    if (std::ranges::any_of(kOthers, names)) return PartKind::other;
    if (std::ranges::any_of(kCoverings, names)) kind = PartKind::covering;
  }
  return kind;
}

}  // namespace

PartKind kind_of_part(std::string_view name, std::span<const std::string> materials) {
  if (const std::optional<PartKind> kind = kind_of_name(name)) return *kind;
  std::optional<PartKind> all;
  for (const std::string& material : materials) {
    const PartKind kind = kind_of_name(material).value_or(PartKind::body);
    if (kind == PartKind::body) return kind;
    if (!all || kind == PartKind::covering) all = kind;
  }
  return all.value_or(PartKind::body);
}

}  // namespace ecorche::inline v1
