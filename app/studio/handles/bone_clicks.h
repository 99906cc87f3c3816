// Places of muscles that are clicked on bones: a new muscle from two clicks, a point of a line from
// one.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/posed_anatomy.h"
#include "app/edit/document/workshop.h"
#include "viewer/window/window_tool.h"

namespace ecorche {

// A place on a bone's surface.
struct BonePlace {
  std::string text;           // as actions take it, of the left side: humerus@150,1200,-20
  Vec3 place = Vec3::Zero();  // the same, m, as table_place()
  Side side = Side::left;     // of the bone that was clicked
  int joint = -1;             // of the shown skeleton, that carries it
  Vec3 rest = Vec3::Zero();   // in the shown body, at rest, world
};

// The nearest to the eye of those under a pixel; none: no bone of the built-in skeleton is there.
// `shown`: the displayed body, of which the bone package's skeleton has the same meshes.
std::optional<BonePlace> bone_under(const Anatomy& shown, std::span<const Vec3> joint_rest,
                                    const PosedAnatomy& posed, const ViewProjection& view,
                                    const Vec2f& pixel, Workshop& workshop);

// What the next click on a bone is for.
struct BoneClick {
  enum class For { origin, insertion, point, area } what = For::origin;
  std::optional<BonePlace> origin{};  // of a new muscle, once it is clicked
  int strip = 1, point = 1;           // of the picked muscle, counted from 1
  bool paints_origin = true;          // an area: of its origin; else of its insertion
  bool painting = false;              // the button is down
  std::vector<BonePlace> painted{};   // so far
};

// Takes a place into a painted area, where none is near it.
void paint(const BonePlace& place, BoneClick& click);
// The line that a painted area is.
std::string line_of_area(const BoneClick& click, const Document& document);

// A line of a script: a new muscle of a free name, a tenth as thick as its line is long and at most
// 30 mm, or the picked muscle's point at the place.
std::string line_of_click(const BoneClick& click, const BonePlace& place, const Document& document);

}  // namespace ecorche
