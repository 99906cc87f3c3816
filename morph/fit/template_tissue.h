// The template's soft tissue, made once and cached: what carries its inside into other bodies.
#pragma once

#include <string>
#include <string_view>

#include "morph/template/template.h"
#include "morph/tissue/interior_warp.h"
#include "morph/tissue/tissue_mesh.h"

namespace ecorche::inline v1 {

// Of the built-in body and bones. `interior`: tetgen or lattice. Throws as tetgen_tissue and
// lattice_tissue do.
TissueMesh template_tissue(const Template& body_template, Interior interior);

// As bytes, for the cache. read_tissue_bytes throws InputError for anything but what
// write_tissue_bytes gave.
std::string write_tissue_bytes(const TissueMesh& mesh);
TissueMesh read_tissue_bytes(std::string_view bytes);

}  // namespace ecorche::inline v1
