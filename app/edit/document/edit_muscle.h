// One muscle of a document changed, on both sides or on one, and the points that its lines go
// through.
#pragma once

#include <functional>
#include <string>

#include "app/edit/document/workshop.h"

namespace ecorche {

// A muscle by its name; with _l or _r at its end that side alone is meant, without both. Empty: the
// one that was picked. Throws InputError with the most similar names.
struct MeantMuscle {
  int entry = 0;
  Side side = Side::middle;
};
MeantMuscle meant_muscle(const Document& document, const std::string& name);

using MuscleChange = std::function<void(TableMuscle&)>;
// Throws InputError, as the reader of the table does, for what is no muscle after the change.
Document with_change(const Document& document, const MeantMuscle& meant,
                     const MuscleChange& change);

// A strip, a point, counted from 1. Throws InputError that says how many there are.
TableStrip& strip_of(TableMuscle& muscle, int strip);
TablePoint& point_of(TableMuscle& muscle, int strip, int point);

// A place of the source skeleton as the table has it: m to the left of the mid-plane (of the right
// side: to the right), up and front.
Vec3 table_place(const Vec3& source, Side side);

// A place as scripts write it:
//   LANDMARK                of data/landmarks
//   LANDMARK+LEFT,UP,FRONT  and so far from it, mm
//   BONE@LEFT,UP,FRONT      on a bone's surface, where it is nearest to this place of the source
//                           frame, mm; said by the nearest landmark of the bone
// Throws InputError for anything else, with the most similar names.
TablePoint read_place(Workshop& workshop, const Document& document, const std::string& text);

// The same landmark, or the bone's nearest one, for another place in the source frame.
TablePoint place_on_bone(Workshop& workshop, const Document& document, const std::string& bone,
                         const Vec3& place);

Vec3 metres(const Vec3& millimetres);

}  // namespace ecorche
