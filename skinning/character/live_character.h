// An anatomy that follows an edited skin at once, without being fitted anew: for live editing.
#pragma once

#include <vector>

#include "anatomy/character.h"
#include "morph/tissue/interior_interpolation.h"

namespace ecorche::inline v1 {

// Fixed combinations of skin vertices, made once a character.
class LiveAnatomy {
 public:
  // Borrowed. Its skin has to be of some thousand vertices. Throws as make_carrier.
  explicit LiveAnatomy(const Character& character);

  // What is inside goes where the skin takes it (interior_interpolation.h): bone vertices, joint
  // centres and axes, paths, wraps and sections of muscles, fascia. Names stay; so do sections'
  // places along their lines, limits of joints. Precondition: a finite skin of as many vertices.
  void follow(const Points& skin);

  const Character& character() const {
    return character_;
  }  // as followed last; its sections as ellipses: slices()
  const std::vector<Ellipse>& slices() const { return slices_; }

 private:
  void follow_skeleton(Eigen::Index row);
  void follow_muscles(Eigen::Index slice_row, Eigen::Index path_row);

  const Character& start_;
  Character character_;
  std::vector<Ellipse> slices_;
  SkinInterpolation carrier_;
  Eigen::Index slice_row_ = 0, path_row_ = 0, fascia_row_ = 0, joint_row_ = 0;  // bones begin at 0
  Points moved_;
};

}  // namespace ecorche::inline v1
