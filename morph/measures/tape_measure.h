// Measuring a body as a tape, a stick and a calliper do, and how each measure changes when the skin
// moves.
//
// Girths are the loop of a plane's cut that lies nearest to a landmark (its convex hull where the
// tape bridges hollows); paths run over the skin along chains of points on edges, found once on the
// base mesh. Landmarks, chains and loops are tied to the package's topology, so every body made
// from it is measured at the same places. Paired measures are taken on the left side. Definitions
// after ISO 7250-1:2017, ISO 8559-1:2017 and the ANSUR II measurer's handbook, as
// data/body/measures.csv states them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "morph/measures/measure_section.h"
#include "morph/measures/measure_table.h"

namespace ecorche::inline v1 {

class TapeMeasure {
 public:
  // Throws InputError for damaged tables, UnfitError when a chain of a path cannot be found.
  TapeMeasure(const BodyPackage& package, MeasureTable table);

  const MeasureTable& table() const { return table_; }
  int count() const { return int(table_.measures.size()); }
  const Measure& measure(int k) const { return table_.measures[k]; }

  // A measure as people write it: "92cm", "0.92 m", "36.2in", "3ft1", "70kg"; without a unit metres
  // (kilograms for the mass), where nothing else can be meant (anatomy/files/quantity.h). `what`
  // names it in messages. Throws UsageError.
  double parse(int k, std::string_view text, const std::string& what) const;

  // Value of measure k in metres (kilograms for the mass); NaN where the plane misses the skin.
  // `gradient` and `trace` are overwritten when given. Precondition: V has at least #skin rows in
  // the base mesh's order.
  double take(int k, const Points& V, MeasureGradient* gradient = nullptr,
              TapeTrace* trace = nullptr) const;

  // All of them, in order.
  std::vector<double> take_all(const Points& V) const;

 private:
  struct EdgePoint {
    int a = 0, b = 0;
    double t = 0;  // point = (1 - t) a + t b
  };

  void build_parts(const BodyPackage& package);
  std::vector<EdgePoint> chain(const Points& V, int from, int to) const;
  static void shorter_way(const std::vector<SkinCrossing>& loop, const Points& V, int from, int to,
                          std::vector<EdgePoint>& best, double& best_length);
  void build_chains(const Points& base);

  double take_path(int k, const Points& V, MeasureGradient* gradient, TapeTrace* trace) const;
  double take_height(const Measure& m, const Points& V, MeasureGradient* gradient,
                     TapeTrace* trace) const;
  double take_mass(const Points& V, MeasureGradient* gradient) const;

  MeasureTable table_;
  Points base_;  // #skin x 3: the base mesh, for what is usual
  SectionMesh mesh_;
  std::vector<std::vector<int>> starts_;  // a measure: triangles on which its loop may be found
  std::vector<std::vector<EdgePoint>> chains_;  // a measure: of paths
  std::vector<int> soles_;                      // vertices of the feet
  Triangles capped_;  // the closed skin, for the volume; one centre a cavity follows the vertices
  std::vector<std::vector<int>> caps_;  // rims of the cavities
};

}  // namespace ecorche::inline v1
