#include "app/verbs/forces/effort_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

// Mean of the muscles of one side; empty where there are none.
std::vector<double> mean_effort(const Anatomy& anatomy, const MuscleEfforts& efforts,
                                const std::vector<int>& muscles, Side side) {
  std::vector<double> out;
  double total = 0;
  for (const int m : muscles) {
    const Muscle& muscle = anatomy.muscles[std::size_t(m)];
    if (muscle.side != side) continue;
    const double force = std::max(muscle.max_force, 1e-9);
    out.resize(efforts.times.size(), 0);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] += force * efforts.activations(m, Eigen::Index(i));
    total += force;
  }
  for (double& value : out) value /= total;
  return out;
}

// Those that gait laboratories record of a leg, as far as the anatomy has them.
std::vector<ChosenMuscles> gait_muscles(const Anatomy& anatomy) {
  constexpr const char* kNames[] = {
      "gluteus_maximus_*",    "gluteus_medius_*", "psoas_major",
      "rectus_femoris",       "vastus_*",         "semimembranosus",
      "biceps_femoris_long",  "adductor_longus",  "tibialis_anterior",
      "gastrocnemius_medial", "soleus",           "tibialis_posterior",
      "peroneus_longus"};
  std::vector<ChosenMuscles> out;
  for (const char* name : kNames)
    if (std::vector<int> meant = muscles_meant(anatomy, name); !meant.empty())
      out.push_back({name, std::move(meant)});
  return out;
}

}  // namespace

std::vector<ChosenMuscles> choose_muscles(const Anatomy& anatomy, const std::string& list) {
  if (list.empty()) return gait_muscles(anatomy);
  std::vector<ChosenMuscles> out;
  std::istringstream names(list);
  for (std::string name; std::getline(names, name, ',');) {
    std::vector<int> meant = muscles_meant(anatomy, name);
    if (meant.empty())
      throw UsageError(fmt::format("--muscles: no muscle is called '{}'; near are {}", name,
                                   nearest_names(anatomy, name)));
    out.push_back({name, std::move(meant)});
  }
  return out;
}

void add_effort_plots(const Anatomy& anatomy, const MuscleEfforts& efforts,
                      const std::vector<ChosenMuscles>& chosen, HtmlPage& page) {
  page.add_heading("Activations of muscles");
  for (const ChosenMuscles& one : chosen) {
    Plot plot{one.name, "s", "of full effort", efforts.times, {}, {}};
    for (const auto& [side, word] : {std::pair{Side::left, "left"}, std::pair{Side::right, "right"},
                                     std::pair{Side::middle, "middle"}}) {
      std::vector<double> y = mean_effort(anatomy, efforts, one.muscles, side);
      if (!y.empty()) plot.series.push_back({word, std::move(y)});
    }
    page.add_plot(plot);
  }
}

}  // namespace ecorche
