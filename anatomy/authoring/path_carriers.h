// Joints that carry the table's points: of a bone, or of a soft carrier between two joints.
#pragma once

#include <string>

#include "anatomy/anatomy.h"
#include "anatomy/authoring/muscle_table.h"

namespace ecorche::inline v1 {

// Of one side. Keeps references to table and skeleton.
class PathCarriers {
 public:
  PathCarriers(const MuscleTable& table, const Anatomy& source, Side side)
      : table_(table), source_(source), side_(side) {}

  // A point of the left side, in the source frame, on this side. Its height decides the share of a
  // carrier between two heights. Throws InputError that begins with `where` for a carrier that the
  // skeleton lacks.
  PathPoint carry(const std::string& carrier, const Vec3& rest, const std::string& where) const;
  PathPoint carry(const TablePoint& point) const;

  // The name of a bone on this side; unpaired bones keep theirs. Empty for a soft carrier.
  std::string bone_name(const std::string& carrier) const;

 private:
  int joint(const std::string& name, const std::string& where) const;

  const MuscleTable& table_;
  const Anatomy& source_;
  Side side_;
};

}  // namespace ecorche::inline v1
