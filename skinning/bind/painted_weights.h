// Weights set by hand: a table says for some vertices how much of them each joint moves, and takes
// the place of what the binding finds.
#pragma once

#include <filesystem>
#include <vector>

#include "anatomy/files/csv_table.h"
#include "skinning/bind/bind.h"

namespace ecorche {

struct PaintedWeights {
  std::vector<int> vertices;  // of the skin that is bound; of a refined skin's base mesh
  std::vector<std::vector<Influence>> shares;  // rising joint, positive, sum 1
};

// A table with the columns vertex (from 0, in the skin's own order), joint (a joint's name, or a
// bone's for the joint that it rides on) and weight; vertices that it does not name stay as they
// are. Throws InputError that names file, line and value for a vertex that the skin does not have,
// an unknown name, a weight outside [0, 1], a name that a vertex has twice, weights that do not add
// up to 1 within 0.01, more than 8 joints a vertex, or a table without rows.
PaintedWeights read_painted_weights(const std::filesystem::path& file, const Anatomy& anatomy,
                                    int vertex_count);
PaintedWeights painted_weights(const Table& table, const std::string& name, const Anatomy& anatomy,
                               int vertex_count);

// bind_skin() with painted vertices. What follows from the shares (gradual twist of upper arm and
// thigh, half-way rotations, muscles, the elastic skin) is found as ever; the forearm's own spread
// between ulna and radius is left as it is painted.
Binding bind_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                  const PaintedWeights& painted, const BindOptions& options = {});
Binding bind_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& base,
                  const Refinement& refinement, const TriMesh& fine, const PaintedWeights& painted,
                  const BindOptions& options = {});

// Every joint's share of every vertex, largest first: of a refined skin, its base mesh's. #V
std::vector<std::vector<Influence>> joint_shares(const Binding& binding);

// The table that read_painted_weights() reads. Throws OutputError.
void write_weights(const std::filesystem::path& file, const Skeleton& skeleton,
                   const Binding& binding);

}  // namespace ecorche
