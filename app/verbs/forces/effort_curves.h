// Curves of muscle activations on a page.
#pragma once

#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "app/pages/html_page.h"
#include "skinning/dynamics/static_optimization.h"

namespace ecorche {

// Indices of the muscles that a list with commas names (muscles_meant), in its order, a word an
// entry; of an empty list, those that gait laboratories record of a leg, as far as the anatomy has
// them. Throws UsageError for a name that means none.
struct ChosenMuscles {
  std::string name;
  std::vector<int> muscles;
};
std::vector<ChosenMuscles> choose_muscles(const Anatomy& anatomy, const std::string& list);

// A plot a name, left and right; where it means several muscles of a side, their mean by the
// largest force.
void add_effort_plots(const Anatomy& anatomy, const MuscleEfforts& efforts,
                      const std::vector<ChosenMuscles>& chosen, HtmlPage& page);

}  // namespace ecorche
