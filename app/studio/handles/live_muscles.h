// Muscles as they will be about when the body has been fitted to a changed document, at once:
// placed anew, carried into the fitted body by its bones, and grown as the fitted muscle of that
// name has.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/muscles/transform_muscles.h"
#include "app/edit/document/workshop.h"

namespace ecorche {

// Where rest points of one skeleton lie in another that has bones of the same names and vertices:
// by joint of the other, the affine map that fits its bones best.
class BoneCarrier {
 public:
  BoneCarrier(const Anatomy& from, const Anatomy& to);

  Vec3 carry(const Vec3& place, int joint) const { return maps_[std::size_t(joint)] * place; }
  Mat3 stretch(int joint) const { return maps_[std::size_t(joint)].linear(); }

 private:
  std::vector<Eigen::Affine3d> maps_;  // #joints of `to`
};

// Joints of muscles by their names: those of `from` become those of `to`, or the nearest above that
// it has.
void rename_joints(const Skeleton& from, const Skeleton& to, std::vector<Muscle>& muscles);

// `placed`, grown as `fitted` has from `before`, which was placed and carried in the same way:
// where `placed` is `before`, the result is `fitted`.
Muscle grown_like(Muscle placed, const Muscle& before, const Muscle& fitted);

struct LiveMuscles {
  std::vector<int> entries;           // of the wanted document
  std::vector<Muscle> muscles;        // two an entry, left and right
  std::vector<std::string> replaced;  // names of muscles of the shown body that are seen no more
};

// Makes them for one shown body; keeps what it stands on from one edit to the next.
class LiveMuscleMaker {
 public:
  // `shown`: fitted for the document `of`; all borrowed.
  LiveMuscleMaker(Workshop& workshop, const Document& of, const Anatomy& shown);

  // The muscles that differ; none where more than `most` do. Throws as placed_entry().
  LiveMuscles make(const Document& wanted, int most = 12);
  const BoneCarrier& carrier() const { return carrier_; }

 private:
  std::vector<Muscle> placed(const Document& document, int entry);

  Workshop& workshop_;
  const Document& of_;
  const Anatomy& shown_;
  BoneCarrier carrier_;  // from the template's body
  std::map<std::string, std::vector<Muscle>> before_;
  // The last of each name, which stands as long as nothing that it was made of is another.
  struct Placed {
    Document of;
    std::vector<Muscle> sides;
  };
  std::map<std::string, Placed> placed_;
};

}  // namespace ecorche
