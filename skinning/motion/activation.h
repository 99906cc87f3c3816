// Muscle activations over time: curves in [0, 1] by muscle name.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// Linear between its times, constant before the first and after the last.
struct ActivationCurve {
  std::vector<int> muscles;    // indices of the muscles that it drives
  std::vector<double> times;   // s from the motion's first frame, rising
  std::vector<double> values;  // #times, in [0, 1]
};

// Where several curves drive a muscle, the largest value counts; a muscle without curve is relaxed.
struct Activations {
  int muscles = 0;  // of the anatomy; 0: everything is relaxed
  std::vector<ActivationCurve> curves;
};

// Linear between times, constant before the first and after the last. Preconditions: times rise,
// one value a time, at least one.
double value_between(std::span<const double> times, std::span<const double> values, double seconds);

// One value a muscle. `out` is resized once and then reused; empty for no activations.
void activation_at(const Activations& activations, double seconds, std::vector<double>& out);

// Indices of the muscles that a name stands for, rising; empty for an unknown name. A name without
// side means both sides, `*` stands for any letters and `?` for one, a path
// (`/forceset/soleus_r/activation`, `soleus_r.activation`) for its muscle. `aliases` are other
// people's names and ours, both without side: (gasmed, gastrocnemius_medial); an alias with side
// keeps it (`gasmed_r`, `r_gasmed`). Letter case does not count.
using MuscleAliases = std::vector<std::pair<std::string, std::string>>;
std::vector<int> muscles_meant(const Anatomy& anatomy, std::string_view name,
                               const MuscleAliases& aliases = {});

// The three names of muscles or aliases nearest to an unknown name, for messages (by edit distance,
// "a, b or c").
std::string nearest_names(const Anatomy& anatomy, std::string_view name,
                          const MuscleAliases& aliases = {});

}  // namespace ecorche::inline v1
