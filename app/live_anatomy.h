// A character whose skin is edited: bones, joints, muscles and binding go along at once, without being fitted or bound anew.
#pragma once

#include "app/actor.h"
#include "morph/carry_inside.h"

namespace ecorche {

// Fixed combinations of skin vertices, made once a character.
class LiveAnatomy {
 public:
  // Borrowed: `actor`, whose skin has to be of some thousand vertices. Throws as make_carrier.
  explicit LiveAnatomy(const Actor& actor);

  // What is inside goes where the skin takes it (carry_inside.h): bone vertices, joint centres and axes, paths, wraps and sections of
  // muscles, the points that the skin is anchored to. Weights stay; so do names, sections' places along their lines, limits of joints.
  // Precondition: a finite skin of as many vertices.
  void follow(const Points& skin);

  const Character& character() const { return character_; }  // as followed last; its sections as ellipses: slices()
  const std::vector<Ellipse>& slices() const { return slices_; }
  // Anchors with their distances, joint weights; no tables, so it is for writing and not for deforming.
  const Binding& binding() const { return binding_; }

 private:
  void follow_skeleton(Eigen::Index row);
  void follow_muscles(Eigen::Index slice_row, Eigen::Index path_row);

  const Actor& actor_;
  Character character_;
  Binding binding_;
  std::vector<Ellipse> slices_;
  Carrier carrier_;
  Eigen::Index slice_row_ = 0, path_row_ = 0, joint_row_ = 0, anchor_row_ = 0;  // bones begin at 0
  Points moved_;
};

}  // namespace ecorche
