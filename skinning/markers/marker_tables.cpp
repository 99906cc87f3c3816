#include "skinning/markers/marker_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <utility>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kMillimetre = 1e-3;

double number_if_there(const Table& table, int row, std::string_view column, double otherwise) {
  return table.has_column(column) ? table.number_or(row, column, otherwise) : otherwise;
}

std::string text_if_there(const Table& table, int row, std::string_view column) {
  return table.has_column(column) ? table.text(row, column) : std::string();
}

// Of a body's left side or middle.
MarkerPlace place_of(const Table& table, int row) {
  const auto three = [&](const char* x, const char* y, const char* z) {
    return Vec3(number_if_there(table, row, x, 0), number_if_there(table, row, y, 0),
                number_if_there(table, row, z, 0));
  };
  MarkerPlace out;
  out.joint = table.text(row, "joint");
  out.at = text_if_there(table, row, "at");
  if (out.at.empty()) out.at = out.joint;
  out.toward = text_if_there(table, row, "toward");
  out.share = number_if_there(table, row, "share", 0);
  out.offset = kMillimetre * three("left_mm", "up_mm", "front_mm");
  out.out = three("out_left", "out_up", "out_front");
  out.spread = kMillimetre * number_if_there(table, row, "spread_mm", 20);
  if (!(out.spread > 0) || out.spread > 1)
    throw InputError(fmt::format("{}: spread_mm: {:g}; it is between 0 and 1000", table.where(row),
                                 out.spread / kMillimetre));
  return out;
}

// A joint of the middle has no side.
std::string sided(const std::string& joint, Side side) {
  constexpr std::array<std::string_view, 5> kMiddle = {"pelvis", "thorax", "head", "c7", ""};
  return std::ranges::find(kMiddle, joint) != kMiddle.end() ? joint : joint + side_suffix(side);
}

MarkerPlace on_side(MarkerPlace place, Side side) {
  place.side = side;
  place.name += side_suffix(side);
  for (std::string* joint : {&place.joint, &place.at, &place.toward}) *joint = sided(*joint, side);
  if (side == Side::right) place.offset.x() *= -1, place.out.x() *= -1;
  return place;
}

void add_name(const std::string& marker, const std::string& place, bool paired,
              const std::string& where, MarkerSet& set) {
  const auto add = [&](const std::string& name, const std::string& there) {
    if (!set.places.emplace(plain_marker_name(name), there).second)
      throw InputError(fmt::format("{}: marker '{}' twice", where, name));
  };
  const std::size_t mark = marker.find('?');
  if (paired != (mark != std::string::npos))
    throw InputError(
        fmt::format("{}: marker '{}', place '{}': a '?' stands for the side of places "
                    "that are paired",
                    where, marker, place));
  if (!paired) return add(marker, place);
  for (const Side side : {Side::left, Side::right}) {
    std::string name = marker;
    name[mark] = side == Side::left ? 'L' : 'R';
    add(name, place + side_suffix(side));
  }
}

}  // namespace

std::string plain_marker_name(std::string_view name) {
  const std::size_t subject = name.find_last_of(":|");
  std::string out;
  for (const unsigned char c : name.substr(subject == std::string_view::npos ? 0 : subject + 1))
    if (!std::isspace(c) && c != '.' && c != '_' && c != '-') out += char(std::toupper(c));
  return out;
}

MarkerTables read_marker_tables(const std::filesystem::path& folder) {
  MarkerTables out;
  std::map<std::string, bool> paired;
  const Table places(folder / "places.csv");
  for (int row = 0; row < places.rows(); ++row) {
    MarkerPlace place = place_of(places, row);
    place.name = places.text(row, "place");
    paired[place.name] = places.text(row, "paired") == "yes";
    if (!paired[place.name]) {
      out.places[place.name] = place;
      continue;
    }
    for (const Side side : {Side::left, Side::right}) {
      const MarkerPlace there = on_side(place, side);
      out.places[there.name] = there;
    }
  }
  const Table names(folder / "names.csv");
  for (int row = 0; row < names.rows(); ++row) {
    const std::string set = names.text(row, "set"), place = names.text(row, "place");
    if (!paired.contains(place))
      throw InputError(fmt::format("{}: no place '{}' in places.csv", names.where(row), place));
    if (out.sets.empty() || out.sets.back().name != set) out.sets.push_back({set, {}});
    add_name(names.text(row, "marker"), place, paired[place], names.where(row), out.sets.back());
  }
  return out;
}

void add_own_markers(const std::filesystem::path& file, MarkerTables& tables) {
  const Table table(file);
  tables.own = {printable(file.filename().string()), {}};
  for (int row = 0; row < table.rows(); ++row) {
    const std::string marker = table.text(row, "marker"),
                      place = text_if_there(table, row, "place");
    if (place.empty() && text_if_there(table, row, "joint").empty())
      throw InputError(fmt::format("{}: marker '{}': neither a place nor a joint", table.where(row),
                                   printable(marker)));
    std::string there = place;
    if (place.empty()) {
      MarkerPlace own = place_of(table, row);
      own.name = there = fmt::format("{}, {}", tables.own.name, printable(marker));
      tables.places[there] = own;
    } else if (!tables.places.contains(place)) {
      throw InputError(fmt::format(
          "{}: marker '{}': no place '{}'; data/markers/places.csv lists them, and a side is _l or "
          "_r",
          table.where(row), printable(marker), printable(place)));
    }
    if (!tables.own.places.emplace(plain_marker_name(marker), there).second)
      throw InputError(fmt::format("{}: marker '{}' twice", table.where(row), printable(marker)));
  }
}

std::vector<const MarkerPlace*> find_marker_places(const MarkerTables& tables,
                                                   const std::vector<std::string>& markers) {
  std::vector<std::pair<int, const MarkerSet*>> sets{{1 << 30, &tables.own}};
  for (const MarkerSet& set : tables.sets) {
    int known = 0;
    for (const std::string& marker : markers)
      known += set.places.contains(plain_marker_name(marker));
    sets.emplace_back(known, &set);
  }
  std::ranges::stable_sort(sets, std::greater<>(), [](const auto& set) { return set.first; });
  std::vector<const MarkerPlace*> out;
  for (const std::string& marker : markers) {
    out.push_back(nullptr);
    for (const auto& [known, set] : sets) {
      const auto found = set->places.find(plain_marker_name(marker));
      if (found == set->places.end()) continue;
      out.back() = &tables.places.at(found->second);
      break;
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
