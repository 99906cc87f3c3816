#include "skinning/muscle_lift.h"

namespace ecorche {

void lift_nodes(const SkinTables& tables, const PosedAnatomy&, const std::vector<float>&, std::vector<float>& lifts, std::vector<float>&) {
  lifts.assign(4 * tables.nodes.size(), 0.0f);
}

}  // namespace ecorche
