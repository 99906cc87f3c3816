// ecorche-tetgen QUALITY < surface > tetrahedra: TetGen in a program of its own, because it may end
// or hang on what it does not like, and because its licence (AGPL-3.0-or-later) then stays with
// this program.
//
// In:  #points, #triangles (int64); points (3 doubles each); triangles (3 int32 each). Points
// without triangles lie inside. Out: #points, #tetrahedra (int64); points, those that came in first
// and in their order; tetrahedra (4 int32 each). Where triangles intersect, their corners are moved
// a little towards their neighbours' mean until none do. Exit status: 0, 2 usage, 3 bad input, 5
// over 60 s or 4 GB, 70 where TetGen gave up.
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <set>
#include <string>
#include <vector>

#define TETLIBRARY
#include <tetgen.h>

namespace {

constexpr int kBadInput = 3, kOverLimit = 5, kGaveUp = 70;
constexpr int kRelaxations = 30;
constexpr std::int64_t kMost = 4'000'000;

template <class T>
bool read_all(std::vector<T>& values) {
  return std::fread(values.data(), sizeof(T), values.size(), stdin) == values.size();
}

void fill(const std::vector<double>& points, const std::vector<int>& triangles, tetgenio& in) {
  in.firstnumber = 0;
  in.numberofpoints = int(points.size() / 3);
  in.pointlist = new REAL[points.size()];
  std::copy(points.begin(), points.end(), in.pointlist);
  in.numberoffacets = int(triangles.size() / 3);
  in.facetlist = new tetgenio::facet[triangles.size() / 3];
  for (std::size_t f = 0; f < triangles.size() / 3; ++f) {
    tetgenio::facet& facet = in.facetlist[f];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    facet.polygonlist[0].numberofvertices = 3;
    facet.polygonlist[0].vertexlist =
        new int[3]{triangles[3 * f], triangles[3 * f + 1], triangles[3 * f + 2]};
  }
}

void run(const char* switches, const std::vector<double>& points, const std::vector<int>& triangles,
         tetgenio& out) {
  tetgenio in;
  fill(points, triangles, in);
  std::string options = switches;
  tetrahedralize(options.data(), &in, &out);
}

// Corners of triangles that intersect others.
std::set<int> tangled(const std::vector<double>& points, const std::vector<int>& triangles) {
  tetgenio out;
  run("dQ", points, triangles, out);
  std::set<int> corners;
  if (out.trifacelist)
    corners.insert(out.trifacelist, out.trifacelist + 3 * std::ptrdiff_t(out.numberoftrifaces));
  return corners;
}

void relax(const std::set<int>& corners, const std::vector<int>& triangles,
           std::vector<double>& points) {
  std::vector<std::set<int>> neighbours(points.size() / 3);
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const std::size_t first = k / 3 * 3;
    for (std::size_t c = first; c < first + 3; ++c)
      if (c != k) neighbours[triangles[k]].insert(triangles[c]);
  }
  for (int round = 0; round < 3; ++round) {
    const std::vector<double> before = points;
    for (const int v : corners) {
      const auto& around = neighbours[v];
      for (std::size_t axis = 0; axis < 3 && !around.empty(); ++axis) {
        double sum = 0;
        for (const int n : around) sum += before[3 * n + axis];
        const std::size_t at = 3 * std::size_t(v) + axis;
        points[at] = (before[at] + sum / double(around.size())) / 2;
      }
    }
  }
}

int tetrahedra_of(std::vector<double> points, const std::vector<int>& triangles, double quality) {
  for (int round = 0;; ++round) {
    const std::set<int> corners = tangled(points, triangles);
    if (corners.empty()) break;
    if (round == kRelaxations) return kGaveUp;
    relax(corners, triangles, points);
  }
  tetgenio out;
  run(("pYQq" + std::to_string(quality)).c_str(), points, triangles, out);
  if (out.numberofcorners != 4 || out.numberoftetrahedra < 1) return kGaveUp;
  const std::int64_t counts[] = {out.numberofpoints, out.numberoftetrahedra};
  std::fwrite(counts, sizeof(counts), 1, stdout);
  std::fwrite(out.pointlist, sizeof(double), 3 * std::size_t(counts[0]), stdout);
  std::fwrite(out.tetrahedronlist, sizeof(int), 4 * std::size_t(counts[1]), stdout);
  return std::fflush(stdout) == 0 ? 0 : 6;
}

}  // namespace

int main(int count, char** arguments) {
  const double quality = count == 2 ? std::atof(arguments[1]) : 0;
  if (!(quality > 1 && quality < 100)) {
    std::fputs(
        "usage: ecorche-tetgen QUALITY < surface > tetrahedra   (QUALITY: radius over shortest "
        "edge, above 1)\n",
        stderr);
    return 2;
  }
  const rlimit seconds{60, 61}, bytes{rlim_t{4} << 30, rlim_t{4} << 30}, no_core{0, 0};
  setrlimit(RLIMIT_CPU, &seconds);
  setrlimit(RLIMIT_AS, &bytes);
  setrlimit(RLIMIT_CORE, &no_core);
  std::int64_t counts[2];
  if (std::fread(counts, sizeof(counts), 1, stdin) != 1 || counts[0] < 4 || counts[0] > kMost ||
      counts[1] < 4 || counts[1] > kMost)
    return kBadInput;
  try {
    std::vector<double> points(3 * std::size_t(counts[0]));
    std::vector<int> triangles(3 * std::size_t(counts[1]));
    if (!read_all(points) || !read_all(triangles)) return kBadInput;
    if (!std::ranges::all_of(points, [](double x) { return std::isfinite(x); })) return kBadInput;
    if (!std::ranges::all_of(triangles, [&](int v) { return v >= 0 && v < counts[0]; }))
      return kBadInput;
    return tetrahedra_of(std::move(points), triangles, quality);
  } catch (const std::bad_alloc&) {
    return kOverLimit;
  } catch (...) {  // TetGen throws integers
    return kGaveUp;
  }
}
