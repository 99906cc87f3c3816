// Weights set by hand: a table that says for some vertices how much of them each joint moves, in
// place of the weights that binding finds.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/files/csv_table.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

struct PaintedWeights {
  std::vector<int> vertices;  // of the skin that is bound; of a refined skin's base mesh
  std::vector<std::vector<Influence>> weights;  // rising joint, positive, sum 1
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

// Every joint's weight for every vertex, largest first. #V
std::vector<std::vector<Influence>> joint_weights_of(const BlendTables& tables);

// The table that read_painted_weights() reads. Throws OutputError.
void write_weights(const std::filesystem::path& file, const Skeleton& skeleton,
                   const BlendTables& tables);

}  // namespace ecorche::inline v1
