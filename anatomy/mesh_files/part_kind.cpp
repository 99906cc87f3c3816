#include "anatomy/mesh_files/part_kind.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <vector>

namespace ecorche::inline v1 {
namespace {

struct KindWord {
  const char* word;
  PartKind kind;
};
constexpr std::array kWords{KindWord{"cloth", PartKind::clothes},
                            KindWord{"clothes", PartKind::clothes},
                            KindWord{"clothing", PartKind::clothes},
                            KindWord{"shirt", PartKind::clothes},
                            KindWord{"tshirt", PartKind::clothes},
                            KindWord{"shoe", PartKind::clothes},
                            KindWord{"boot", PartKind::clothes},
                            KindWord{"sock", PartKind::clothes},
                            KindWord{"jacket", PartKind::clothes},
                            KindWord{"coat", PartKind::clothes},
                            KindWord{"vest", PartKind::clothes},
                            KindWord{"pant", PartKind::clothes},
                            KindWord{"trouser", PartKind::clothes},
                            KindWord{"jean", PartKind::clothes},
                            KindWord{"short", PartKind::clothes},
                            KindWord{"skirt", PartKind::clothes},
                            KindWord{"dress", PartKind::clothes},
                            KindWord{"robe", PartKind::clothes},
                            KindWord{"suit", PartKind::clothes},
                            KindWord{"armor", PartKind::clothes},
                            KindWord{"armour", PartKind::clothes},
                            KindWord{"glove", PartKind::clothes},
                            KindWord{"gauntlet", PartKind::clothes},
                            KindWord{"cape", PartKind::clothes},
                            KindWord{"cloak", PartKind::clothes},
                            KindWord{"scarf", PartKind::clothes},
                            KindWord{"belt", PartKind::clothes},
                            KindWord{"underwear", PartKind::clothes},
                            KindWord{"bra", PartKind::clothes},
                            KindWord{"brief", PartKind::clothes},
                            KindWord{"boxer", PartKind::clothes},
                            KindWord{"bikini", PartKind::clothes},
                            KindWord{"sweater", PartKind::clothes},
                            KindWord{"hoodie", PartKind::clothes},
                            KindWord{"garment", PartKind::clothes},
                            KindWord{"outfit", PartKind::clothes},
                            KindWord{"sandal", PartKind::clothes},
                            KindWord{"sneaker", PartKind::clothes},
                            KindWord{"stocking", PartKind::clothes},
                            KindWord{"tight", PartKind::clothes},
                            KindWord{"legging", PartKind::clothes},
                            KindWord{"uniform", PartKind::clothes},
                            KindWord{"costume", PartKind::clothes},
                            KindWord{"blouse", PartKind::clothes},
                            KindWord{"greave", PartKind::clothes},
                            KindWord{"cuirass", PartKind::clothes},
                            KindWord{"pauldron", PartKind::clothes},
                            KindWord{"footwear", PartKind::clothes},
                            KindWord{"hood", PartKind::clothes},
                            KindWord{"helmet", PartKind::headgear},
                            KindWord{"hat", PartKind::headgear},
                            KindWord{"cap", PartKind::headgear},
                            KindWord{"mask", PartKind::headgear},
                            KindWord{"headwear", PartKind::headgear},
                            KindWord{"eyebrow", PartKind::hair},
                            KindWord{"brow", PartKind::hair},
                            KindWord{"eyelash", PartKind::hair},
                            KindWord{"lash", PartKind::hair},
                            KindWord{"hair", PartKind::hair},
                            KindWord{"beard", PartKind::hair},
                            KindWord{"mustache", PartKind::hair},
                            KindWord{"moustache", PartKind::hair},
                            KindWord{"ponytail", PartKind::hair},
                            KindWord{"eye", PartKind::eyes},
                            KindWord{"eyeball", PartKind::eyes},
                            KindWord{"cornea", PartKind::eyes},
                            KindWord{"iris", PartKind::eyes},
                            KindWord{"sclera", PartKind::eyes},
                            KindWord{"tear", PartKind::eyes},
                            KindWord{"tearline", PartKind::eyes},
                            KindWord{"teeth", PartKind::mouth},
                            KindWord{"tooth", PartKind::mouth},
                            KindWord{"tongue", PartKind::mouth},
                            KindWord{"gum", PartKind::mouth},
                            KindWord{"denture", PartKind::mouth},
                            KindWord{"prop", PartKind::prop},
                            KindWord{"weapon", PartKind::prop},
                            KindWord{"sword", PartKind::prop},
                            KindWord{"shield", PartKind::prop},
                            KindWord{"gun", PartKind::prop},
                            KindWord{"rifle", PartKind::prop},
                            KindWord{"pistol", PartKind::prop},
                            KindWord{"bow", PartKind::prop},
                            KindWord{"arrow", PartKind::prop},
                            KindWord{"staff", PartKind::prop},
                            KindWord{"axe", PartKind::prop},
                            KindWord{"spear", PartKind::prop},
                            KindWord{"knife", PartKind::prop},
                            KindWord{"bag", PartKind::prop},
                            KindWord{"backpack", PartKind::prop},
                            KindWord{"glasses", PartKind::prop},
                            KindWord{"watch", PartKind::prop},
                            KindWord{"earring", PartKind::prop},
                            KindWord{"jewelry", PartKind::prop},
                            KindWord{"necklace", PartKind::prop},
                            KindWord{"badge", PartKind::prop},
                            KindWord{"horn", PartKind::prop},
                            KindWord{"tail", PartKind::prop},
                            KindWord{"wing", PartKind::prop},
                            KindWord{"quiver", PartKind::prop},
                            KindWord{"scabbard", PartKind::prop},
                            KindWord{"floor", PartKind::surroundings},
                            KindWord{"ground", PartKind::surroundings},
                            KindWord{"pedestal", PartKind::surroundings},
                            KindWord{"base_plate", PartKind::surroundings},
                            KindWord{"plinth", PartKind::surroundings},
                            KindWord{"background", PartKind::surroundings},
                            KindWord{"wall", PartKind::surroundings},
                            KindWord{"camera", PartKind::surroundings},
                            KindWord{"light", PartKind::surroundings},
                            KindWord{"collider", PartKind::surroundings},
                            KindWord{"icosphere", PartKind::surroundings}};

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

// The longest of the words that it is: "eyebrow" is no eye.
std::optional<PartKind> kind_of_word(const std::string& word) {
  const KindWord* best = nullptr;
  for (const KindWord& one : kWords)
    if (is_word(word, one.word) && (best == nullptr || std::string_view(one.word).size() >
                                                           std::string_view(best->word).size()))
      best = &one;
  if (best == nullptr) return std::nullopt;
  return best->kind;
}

std::optional<PartKind> kind_of_name(std::string_view name) {
  std::optional<PartKind> kind;
  for (const std::string& word : words_of(name)) {
    if (word == "body" || word == "skin" || word == "head") return PartKind::body;
    const std::optional<PartKind> said = kind_of_word(word);
    // "Shirt_button_eye" is no shirt.
    if (said && (!kind || !shows_body(*said))) kind = said;
  }
  return kind;
}

}  // namespace

PartKind kind_of_part(std::string_view name, std::span<const std::string> materials) {
  const std::optional<PartKind> own = kind_of_name(name);
  if (own && *own != PartKind::body) return *own;
  std::optional<PartKind> all;
  for (const std::string& material : materials) {
    const PartKind kind = kind_of_name(material).value_or(PartKind::body);
    if (kind == PartKind::body) return kind;
    if (!all || is_covering(kind)) all = kind;
  }
  // What is called a body may be painted with its clothes.
  if (own && all && is_covering(*all)) return PartKind::body;
  return all.value_or(PartKind::body);
}

}  // namespace ecorche::inline v1
