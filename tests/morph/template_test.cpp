// The template: complete, mirrored, inside its body, and read back from its cache as it was
// written.
#include "morph/template/template.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "anatomy/errors.h"
#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/queries/signed_distance.h"
#include "morph/template/template_cache.h"
#include "tests/morph/built_template.h"

namespace ecorche {
namespace {

TEST(Template, Has178BonesAnd400Muscles) {
  NEED_TEMPLATE();
  EXPECT_EQ(tmpl.anatomy.bones.size(), 178u);
  EXPECT_GE(tmpl.anatomy.muscles.size(), 400u);
  EXPECT_NO_THROW(validate(tmpl.anatomy));
}

TEST(Template, LeftAndRightMirror) {
  NEED_TEMPLATE();
  double worst = 0;
  for (const Bone& bone : tmpl.anatomy.bones) {
    if (bone.side != Side::left) continue;
    const int other = find_bone(tmpl.anatomy, bone.name.substr(0, bone.name.size() - 2) + "_r");
    ASSERT_GE(other, 0) << bone.name;
    const Points& R = tmpl.anatomy.bones[other].mesh.V;
    ASSERT_EQ(R.rows(), bone.mesh.V.rows());
    Points M = R;
    M.col(0) *= -1;
    worst = std::max(worst, (M - bone.mesh.V).rowwise().norm().maxCoeff());
  }
  EXPECT_LT(worst, 1e-3);
}

TEST(Template, NoBoneVertexIsOutsideItsSkin) {
  NEED_TEMPLATE();
  const SkinField skin(capped_skin(tmpl.tables.topology, tmpl.body.skin.V));
  int outside = 0;
  for (const Bone& bone : tmpl.anatomy.bones)
    for (int i = 0; i < bone.mesh.V.rows(); ++i)
      outside += skin.winding_number(bone.mesh.V.row(i)) < 0.5;
  EXPECT_EQ(outside, 0);
}

// Where a section's middle lies in a neighbour, packing presses it to a rag: the recti ended in two
// stalks below a hole while they began within the pectorals.
TEST(Template, NoRectusRunsThroughAPectoral) {
  NEED_TEMPLATE();
  const MuscleSurface surface = make_muscle_surface(tmpl.anatomy);
  Points drawn;
  update_muscle_surface(surface, rest_slices(tmpl.anatomy), drawn);
  constexpr int kAcross = 3;  // points over the middle quarter of a section's width
  for (const std::string side : {"_l", "_r"}) {
    const int rectus = find_muscle(tmpl.anatomy, "rectus_abdominis" + side);
    ASSERT_GE(rectus, 0);
    const std::vector<Ellipse> sections =
        rest_slices(tmpl.anatomy.muscles[std::size_t(rectus)].strips[0]);
    Points middles(kAcross * Eigen::Index(sections.size()), 3);
    for (std::size_t k = 0; k < sections.size(); ++k)
      for (int i = 0; i < kAcross; ++i)
        middles.row(kAcross * Eigen::Index(k) + i) =
            sections[k].center +
            0.25 * (2.0 * i / (kAcross - 1) - 1) * sections[k].radii.x() * sections[k].axes.col(0);
    for (const MuscleSurface::Part& part : surface.parts) {
      const Muscle& other = tmpl.anatomy.muscles[std::size_t(part.muscle)];
      if (!other.name.starts_with("pectoralis_major")) continue;
      const std::vector<int> turns = winding_numbers(part_mesh(surface, part, drawn), middles);
      for (std::size_t i = 0; i < turns.size(); ++i)
        EXPECT_EQ(turns[i], 0) << other.name << " holds point " << i % kAcross << " of section "
                               << i / kAcross << side << " at " << middles.row(Eigen::Index(i));
    }
  }
}

TEST(Template, CentreRegressorGivesTheTemplatesOwnCentres) {
  NEED_TEMPLATE();
  const NamedPoints centres = joint_centres(tmpl.tables.regressor, tmpl.body.skin.V);
  EXPECT_GT(centres.size(), 40u);
  for (const auto& [name, centre] : centres)
    EXPECT_LT((centre - tmpl.tables.half.points.at(name)).norm(), 1e-7) << name;
}

TEST(Template, CentreRegressorFollowsAffineMaps) {
  NEED_TEMPLATE();
  Mat3 A;
  A << 1.1, 0.2, 0, -0.1, 0.9, 0.05, 0.3, 0, 1.2;
  const Vec3 shift(3, -2, 1);
  const Points moved = (tmpl.body.skin.V * A.transpose()).rowwise() + shift.transpose();
  const NamedPoints before = joint_centres(tmpl.tables.regressor, tmpl.body.skin.V);
  for (const auto& [name, centre] : joint_centres(tmpl.tables.regressor, moved))
    EXPECT_LT((centre - (A * before.at(name) + shift)).norm(), 1e-9) << name;
}

TEST(Template, CacheGivesBackWhatWasWritten) {
  NEED_TEMPLATE();
  const std::string bytes = write_template_bytes(tmpl);
  EXPECT_EQ(write_template_bytes(read_template_bytes(bytes, tmpl.tables.fat)), bytes);
  std::string damaged = bytes;
  damaged[damaged.size() / 2] ^= 1;
  EXPECT_THROW(read_template_bytes(damaged, tmpl.tables.fat), InputError);
  EXPECT_THROW(read_template_bytes(bytes.substr(0, 1000), tmpl.tables.fat), InputError);
  EXPECT_THROW(read_template_bytes("", tmpl.tables.fat), InputError);
}

}  // namespace
}  // namespace ecorche
