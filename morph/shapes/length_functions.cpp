#include "morph/shapes/length_functions.h"

#include <algorithm>

#include <fmt/format.h>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "morph/shapes/region_functions.h"

namespace ecorche::inline v1 {
namespace {

int landmark_vertex(const MeasureTable& table, const Table& rows, int row, const char* column) {
  const std::string& id = rows.text(row, column);
  for (const SkinLandmark& landmark : table.landmarks)
    if (landmark.id == id) return landmark.vertex;
  throw InputError(
      fmt::format("{}: {} '{}': no such landmark in landmarks.csv", rows.where(row), column, id));
}

// Integral of the window from 0 to t, as a share of the whole.
double risen(double t, double tapered) {
  constexpr int kSteps = 64;
  double below = 0, all = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double at = (i + 0.5) / kSteps, window = tukey_window(at, tapered);
    all += window;
    below += window * std::clamp(t * kSteps - i, 0.0, 1.0);
  }
  return below / all;
}

bool is_arm(BodyPart part) {
  return part == BodyPart::upper_arm || part == BodyPart::forearm || part == BodyPart::hand;
}

}  // namespace

Eigen::MatrixXd length_functions(const BodyPackage& package, const MeasureTable& table,
                                 const Points& V, const std::filesystem::path& folder) {
  const Table rows(folder / "lengths.csv");
  const std::vector<VertexPart> parts = vertex_parts(package);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * package.skin_size, rows.rows());
  for (int row = 0; row < rows.rows(); ++row) {
    const double low = V(landmark_vertex(table, rows, row, "from"), 1),
                 high = V(landmark_vertex(table, rows, row, "to"), 1);
    const double tapered = rows.number(row, "tapered"), sd = 1e-3 * rows.number(row, "sd_mm");
    if (!(high > low) || !(tapered >= 0 && tapered <= 1))
      throw InputError(
          fmt::format("{}: 'to' must lie above 'from', and 'tapered' in 0 .. 1", rows.where(row)));
    for (int v = 0; v < package.skin_size; ++v) {
      const bool arm = is_arm(parts[v].part);
      out(3 * v + 1, row) = sd * (arm ? 1 : risen((V(v, 1) - low) / (high - low), tapered));
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
