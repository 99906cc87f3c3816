// Figures of a fit: how well the muscles fill the skin, what the body is made of, and which
// accuracy targets are missed.
#pragma once

#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/body_package.h"
#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/dilation/dilate_muscles.h"
#include "morph/fat/fat_layer.h"
#include "morph/fit/fit_anatomy.h"
#include "morph/fit/shown_through.h"

namespace ecorche::inline v1 {

// How well the muscles fill the skin.
struct FillReport {
  int points = 0;                     // of all muscle surfaces
  int points_outside = 0;             // outside the skin, mouth and eyes closed off
  double furthest = 0;                // m
  int superficial_slices = 0;         // belly sections of superficial limb muscles
  double superficial_gap_median = 0;  // from their nearest approach to the fat layer, m
  // What `check` asks for at rest, measured as there (measure_rest): what muscles share with one
  // another and with bones, of their volume; the largest share of one muscle's volume that lies in
  // bones, and whose; ends off their bones; of the area under the layer, how much is filled.
  double overlap_share = 0, bone_share = 0;
  double pierced_share = 0;
  std::string pierced_muscle;
  int loose_ends = 0;
  double filled_share = 1;
  // m^2 where muscles and bones show through what covers them in the template; of it the bone or
  // deep muscle that shows most (shown_through.h)
  double shown = 0, shown_by_one = 0;
  std::string shown_most;
  // muscles that are torn at rest, the worst first, and needles of all (torn_muscles.h)
  std::vector<std::string> torn;
  int needles = 0;
};

// What the body is made of, m^3. Bones are taken as solid; where muscles overlap, their volume
// counts once, and where they lie in bone, not at all.
struct Tissues {
  double body = 0;  // inside the closed skin
  double bones = 0;
  double muscles = 0;
  double layer = 0;  // fat and skin over the muscles, and breasts
  double rest = 0;   // organs, vessels, deep fat, what is left
};

// Mean densities, kg/m^3: whole skeleton 1300, organs 1050 (ICRP Publication 89); muscle's is in
// muscle_mass.h, adipose tissue's in body_composition.h.
inline constexpr double kBoneDensity = 1300, kOrganDensity = 1050;

struct FittingReport {
  FitReport fit;
  DilateReport dilation;
  double dilation_ms = 0;  // fat layer and dilation
  FillReport fill;
  Tissues tissues;  // zeros where they were not measured
};

// Upper arm, forearm, thigh and shank.
bool is_limb(BodyPart part);

// Whether a palpable point lies outside its bracket by more than kDepthSlack.
bool is_off(const LandmarkDepth& landmark);

// `wall`: of chest_wall_skin; `fat`: of its vertices; `parts`: vertex_parts of the package.
FillReport measure_fill(const Anatomy& anatomy, const TriMesh& closed_skin, const SkinRays& wall,
                        const FatLayer& fat, const std::vector<VertexPart>& parts);
// Of muscles that have parted from bones, along the lines that `check` takes; `wall`, `fat` and
// `parts` as for measure_fill.
void measure_rest(const Anatomy& anatomy, const TriMesh& wall, const FatLayer& fat,
                  const std::vector<VertexPart>& parts, FillReport& fill);
// Against what lies over what in the template.
void measure_shown(const LayerOrder& layers, const LayeredBody& body, FillReport& fill);
// Against the template's muscles, grown to its own skin.
void measure_torn(const Anatomy& anatomy, const std::vector<Muscle>& reference, FillReport& fill);
Tissues measure_tissues(const Anatomy& anatomy, const TriMesh& closed_skin, const TriMesh& wall,
                        const FatLayer& fat);

struct MissedTarget {
  // bones_outside, muscles_outside, muscles_overlap, muscles_in_bones, muscle_pierced, ends_loose,
  // layer_unfilled, shown_through, muscles_torn, superficial_gap, muscles_collapsed, or a landmark
  // of data/palpable.csv
  std::string name;
  std::string what;  // with the figures
};

// The accuracy targets that a fit misses; empty when it meets them all. Exit code 8 rests on it.
std::vector<MissedTarget> missed_targets(const FittingReport& report);

}  // namespace ecorche::inline v1
