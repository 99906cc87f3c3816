// The sections of all muscles of a body while they are packed (pack_muscles.h): which directions
// are drawn, which strip a section belongs to, and where two muscles have the same level.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/queries/ray_crossings.h"

namespace ecorche::inline v1 {

struct StripPlace {
  int muscle = 0;
  bool sheet = false;
  std::size_t begin = 0, end = 0;  // slices
  int label = 0;                   // of its surface: a sheet's strips have one
};

// The factor of an outline that moves a term of a drawn vertex; the term moves with none when u and
// v are 0.
std::size_t outline_place(const MuscleSurface::Term& term);

// What a drawn vertex lies about: the mean of the centres that it follows.
Vec3 root_of(const MuscleSurface& surface, int vertex, std::span<const Ellipse> slices);

struct PackedSections {
  std::vector<Ellipse> slices;  // to the micrometre
  std::vector<StripPlace> strips;
  std::vector<std::size_t> muscle_begin;  // #muscles + 1, slices
  std::vector<std::size_t> strip_begin;   // #muscles + 1, into strips
  std::vector<double> belly, thickness;   // #slices
  std::vector<char>
      drawn;  // #slices x kOutlinePoints: the factor moves a vertex of the drawn surface
  // #muscles: of a mirror image its partner, itself where its outlines are given, else -1
  std::vector<int> partners;
  std::vector<double> weights;  // #muscles, of their levels

  // All of a tube's directions are drawn, of a sheet's strips the sides and the outer edges.
  PackedSections(const Anatomy& anatomy, const MuscleSurface& surface,
                 std::span<const Ellipse> given, std::span<const int> mirrored);

  bool is_drawn(std::size_t k, std::size_t i) const { return drawn[k * kOutlinePoints + i] != 0; }
  bool is_mirrored(const StripPlace& strip) const { return partners[strip.muscle] >= 0; }
  // Directions that are not drawn get what lies between those that are.
  void fill(std::size_t k, SliceOutline& outline) const;
  // From a section's centre to its drawn ellipse.
  Vec3 edge(std::size_t k, std::size_t i) const;

  // Where a muscle that lies on the ray from the centre of slice k of `own`, in `interval`, has to
  // be separated from the section whose surface is at `radius`: where levels are equal, 0 on the
  // line of centres, 1 on the surface.
  double part(std::size_t k, std::size_t own, const Vec3& direction, double radius,
              const RayInterval& interval) const;

 private:
  double level(std::size_t k, const Vec3& p) const;
  double level_share(std::size_t slice) const;
  double level_near(const StripPlace& strip, std::size_t k, const Vec3& p) const;
  std::size_t nearest(const StripPlace& strip, const Vec3& p) const;
};

// Where the sections of each muscle begin among those of all, and their count. #muscles + 1
std::vector<std::size_t> slice_begins(std::span<const Muscle> muscles);

// Outlines of `left` seen in a mirror across x, in the axes of `right`. Nothing happens where their
// counts differ.
void mirror_outlines(std::span<const Ellipse> left, std::span<Ellipse> right);

// A strip's outlines, each half its own and half its neighbours' along and round the strip.
void smooth_outlines(std::span<SliceOutline> outlines);

// To a micrometre: whether two muscles meet must not depend on the last digits of a position that
// is computed in two ways.
double rounded(double x);
std::vector<Ellipse> rounded_sections(std::span<const Ellipse> slices);

}  // namespace ecorche::inline v1
