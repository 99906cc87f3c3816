// The points of a file's parts: welded and whole where they are few, thinned where they are many.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "anatomy/mesh_files/mesh_file.h"
#include "anatomy/mesh_files/part_kind.h"
#include "morph/registration/scan.h"

namespace ecorche::inline v1 {

// Points and faces of all parts that show a body, in metres by `unit`. Up to 400,000 faces (or
// points of a cloud) are kept as they are: equal vertices welded, faces without area, doubled or
// with corners that are not finite left out, `F` filled. More are thinned to cells of 3 mm, wider
// where they would be more than 2 million: the mean position and normal of the area in each, apart
// for surfaces that face different ways, `F` empty. Normals are those of the faces as wound; of
// bare points, whose `area` is zero, those of the file or zero. Memory: 150 MB beside the file.
// `kinds`: of each part. Precondition: unit > 0.
Scan gather_points(const MeshFile& file, std::span<const PartKind> kinds, double unit);

// Points whose `keep` is 0 go, the faces at them, and points of a mesh that then have no face.
void keep_points(Scan& scan, std::vector<char> keep);

// Area-weighted normals and the areas of the points of a scan with faces. Where a fine mesh is
// rough from noise, normals are smoothed over some 10 mm.
void measure_faces(Scan& scan);

// Points in cells of that width, the one nearest to each cell's mean: their numbers, rising.
std::vector<int> cell_points(const Points& points, double width);

// At most `count` points that are spread evenly over the surface, however dense the scan is from
// part to part; all where the scan has fewer. Numbers of points, rising.
std::vector<int> spread_points(const Scan& scan, int count);

}  // namespace ecorche::inline v1
