// Which points of a scan are not of a person: noise, floors and walls, islands, insides.
//
// Each function says which points may stay (1) in one value a point; keep_points takes the others
// away. Scans in metres with normals and areas.
#pragma once

#include <string>
#include <vector>

#include "morph/registration/cloud_neighbours.h"
#include "morph/registration/scan.h"

namespace ecorche::inline v1 {

// Points of a cloud that lie 2.5 times farther apart than their neighbours do, or eight times
// farther than is usual.
std::vector<char> without_outliers(const Points& points, const CloudNeighbours& near);

// Vertices of a mesh that stick out of their ring by two (of coarse meshes three) times its edges
// go to its middle. Returns how many; normals are then out of date.
int level_spikes(Scan& scan);

// What was seen of planes that are no body: floor, top and underside of a pedestal with its rim,
// walls. A plane counts that is wider than 0.2 m with more than 0.05 m^2 in one piece where all
// else stands on one side of it, or larger than 0.35 m^2 anywhere. Points within 8 mm of it that
// face its way go; soles on it face the other way and stay. Appends to scan.notes, and sets scan.up
// by a floor. Same scan, same answer.
std::vector<char> without_planes(Scan& scan, const CloudNeighbours& near);

// The main piece (connected by faces or by gaps under 15 mm, wider in sparse clouds) and those of
// more than 2 % of the area within 0.25 m of it. Appends to scan.notes.
std::vector<char> without_islands(Scan& scan, const CloudNeighbours& near);

}  // namespace ecorche::inline v1
