// Markers: files are read as stated, derivatives are those of the figure, a take of markers laid on
// our own moving figure comes back as it was, with the sizes that it had, through gaps, and
// recorded people walk as published angles of their joints have it.
#include "skinning/markers/fit_markers.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "anatomy/errors.h"
#include "anatomy/joint_angles.h"
#include "skinning/markers/marker_pose.h"
#include "skinning/motion_files/opensim_read.h"
#include "skinning/motion_files/read_markers.h"
#include "skinning/motion_files/trc_read.h"
#include "tests/skinning/plain_skeleton.h"

using namespace ecorche;

namespace {

namespace fs = std::filesystem;

const fs::path kMarkerCorpus = fs::path(ECORCHE_TEST_DIR) / "corpus" / "markers";
const fs::path kCaptures = fs::path(ECORCHE_SHARED_DIR) / "testdata" / "motion" / "opensim_markers";

MarkerTables our_tables() {
  return read_marker_tables(fs::path(ECORCHE_TEST_DIR) / ".." / "data" / "markers");
}

std::string take_outcome(const std::string& file) {
  const MarkerTake take = read_markers(kMarkerCorpus / file);
  int seen = 0;
  for (const Points& places : take.frames)
    for (const auto& p : places.rowwise()) seen += p.allFinite();
  return fmt::format("ok {} {} {:g} {} {}", take.markers.size(), take.frames.size(), take.fps, seen,
                     take.warnings.size());
}

// Plug-in Gait's names, and points inside of joints.
MarkerTake plug_in_names() {
  MarkerTake out;
  out.name = "own.trc";
  out.markers = {"C7", "T10", "CLAV", "STRN"};
  for (const char* side : {"L", "R"})
    for (const char* name :
         {"FHD", "BHD", "SHO", "UPA", "ELB", "MEP", "FRM", "WRA", "WRB", "FIN", "ASI",
          "PSI", "THI", "KNE", "KNM", "TIB", "ANK", "MED", "HEE", "TOE", "MT5"})
      out.markers.push_back(side + std::string(name));
  return out;
}

// A figure that swings arms and legs.
FigurePose swinging(const MarkerFigure& figure, double t) {
  FigurePose out = attention(figure);
  out.root += Vec3(0.05 * std::sin(2 * t), 0.03 * std::cos(4 * t), 1.2 * t);
  Eigen::VectorXd step = Eigen::VectorXd::Zero(figure.coordinates);
  for (const FigureTurn& turn : figure.turns) {
    const int count = turn.free ? 3 : int(turn.components.size());
    for (int k = 0; k < count; ++k) {
      const double swing = std::sin(3 * t + turn.first + 2 * k);
      step[turn.first + k] =
          turn.free ? 0.3 * swing : 0.4 * turn.spread[turn.components[k]] * (swing + 1.1);
    }
  }
  move_figure(figure, step, out);
  return out;
}

struct OwnTake {
  MarkerTake take;
  std::vector<BodyMarker> markers;
  MarkerFigure figure;
  std::vector<std::vector<Transform>> X;  // #frames
};

// z up, in axes of the file.
OwnTake own_take(const FigureSizes& sizes, int frames) {
  OwnTake out;
  const Skeleton skeleton = plain_skeleton();
  out.take = plug_in_names();
  out.take.fps = 50;
  out.markers = lay_markers(our_tables(), out.take, skeleton, {});
  out.figure = make_figure(skeleton);
  set_sizes(sizes, out.figure);
  Pose pose;
  for (int f = 0; f < frames; ++f) {
    figure_kinematics(out.figure, swinging(out.figure, f / out.take.fps), pose,
                      out.X.emplace_back());
    Points& places = out.take.frames.emplace_back(Eigen::Index(out.take.markers.size()), 3);
    for (const BodyMarker& marker : out.markers) {
      const Vec3 p =
          figure_point(out.figure, out.X.back(), marker.joint, marker.local, Vec3::Zero());
      places.row(marker.column) << p.z(), p.x(), p.y();
    }
  }
  return out;
}

// Of hips, knees, ankles, shoulders, elbows and wrists, m, without where the file's origin is.
double worst_centre(const OwnTake& own, const MarkerFit& fit) {
  double worst = 0;
  std::vector<Transform> X;
  for (std::size_t f = 0; f < own.X.size(); ++f) {
    forward_kinematics(fit.figure.skeleton, fit.motion.frames[f], X);
    for (const char* name : {"hip_l", "knee_l", "ankle_l", "shoulder_r", "elbow_r", "wrist_r"}) {
      const std::size_t j = std::size_t(find_joint(own.figure.skeleton, name));
      worst = std::max(worst, (X[j].translation() - own.X[f][j].translation()).norm());
    }
  }
  return worst;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double ma = 0, mb = 0, ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) ma += a[i] / a.size(), mb += b[i] / a.size();
  for (std::size_t i = 0; i < a.size(); ++i)
    ab += (a[i] - ma) * (b[i] - mb), aa += std::pow(a[i] - ma, 2), bb += std::pow(b[i] - mb, 2);
  return ab / std::sqrt(aa * bb);
}

}  // namespace

TEST(Markers, EveryFileOfTheCorpusHasItsStatedOutcome) {
  std::ifstream stream(kMarkerCorpus / "expected.txt");
  int files = 0;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::size_t bar = line.find(" | ");
    const std::string file = line.substr(0, bar), expected = line.substr(bar + 3);
    SCOPED_TRACE(line);
    ++files;
    try {
      const std::string outcome = take_outcome(file);
      EXPECT_EQ(outcome, expected);
    } catch (const Error& e) {
      const std::string message = e.what();
      EXPECT_TRUE(expected.starts_with("error ")) << message;
      EXPECT_NE(message.find(expected.substr(6)), std::string::npos) << message;
      EXPECT_TRUE(message.starts_with(file)) << message;
    }
  }
  EXPECT_GT(files, 40);
}

TEST(Markers, EveryProcessorsFileHoldsTheSamePlaces) {
  const MarkerTake text = read_markers(kMarkerCorpus / "take.trc");
  for (const char* file : {"intel_floats.c3d", "intel_words.c3d", "dec_floats.c3d", "dec_words.c3d",
                           "mips_floats.c3d", "mips_words.c3d", "analog.c3d", "labels_two.c3d"}) {
    SCOPED_TRACE(file);
    const MarkerTake take = read_markers(kMarkerCorpus / file);
    EXPECT_EQ(take.markers, text.markers);
    for (std::size_t f = 0; f < 2; ++f)
      for (Eigen::Index m = 0; m < 3; ++m)
        for (Eigen::Index k = 0; k < 3; ++k) {
          const double a = take.frames[f](m, k), b = text.frames[f](m, k);
          EXPECT_TRUE(std::isnan(b) ? std::isnan(a) : std::abs(a - b) < 1e-6) << a << ' ' << b;
        }
  }
}

TEST(Markers, DerivativesAreDifferences) {
  MarkerFigure figure = make_figure(plain_skeleton());
  const FigurePose at = swinging(figure, 0.7);
  const double h = 1e-6;
  for (const char* name : {"thorax", "head", "scapula_l", "wrist_r", "mtp2_l", "knee_r"}) {
    SCOPED_TRACE(name);
    const int joint = find_joint(figure.skeleton, name);
    const Vec3 local(0.03, -0.05, 0.04), offset(0.01, 0.02, -0.01);
    Pose pose;
    std::vector<Transform> X;
    const auto point = [&](const FigurePose& there) {
      figure_kinematics(figure, there, pose, X);
      return figure_point(figure, X, joint, local, offset);
    };
    Eigen::Matrix3Xd J = Eigen::Matrix3Xd::Zero(3, figure.coordinates);
    Eigen::Matrix<double, 3, int(kFigureSizes.size())> by_size;
    point(at);
    point_derivatives(figure, at, X, joint, local, offset, J, &by_size);
    // The girdle follows the arm, which the derivatives leave out: arms do not move here.
    for (int c = 0; c < figure.coordinates; ++c) {
      bool arm = false;
      for (const FigureTurn& turn : figure.turns)
        arm = arm || (turn.free && turn.parent > 0 && c >= turn.first && c < turn.first + 3);
      if (arm) continue;
      FigurePose less = at, more = at;
      move_figure(figure, -h * Eigen::VectorXd::Unit(figure.coordinates, c), less);
      move_figure(figure, h * Eigen::VectorXd::Unit(figure.coordinates, c), more);
      EXPECT_LT(((point(more) - point(less)) / (2 * h) - J.col(c)).norm(), 1e-6) << c;
    }
    for (int k = 0; k < int(kFigureSizes.size()); ++k) {
      FigureSizes sizes = FigureSizes::Ones();
      sizes[k] += h;
      set_sizes(sizes, figure);
      const Vec3 more = point(at);
      sizes[k] -= 2 * h;
      set_sizes(sizes, figure);
      const Vec3 less = point(at);
      set_sizes(FigureSizes::Ones(), figure);
      EXPECT_LT(((more - less) / (2 * h) - by_size.col(k)).norm(), 1e-6) << k;
    }
  }
}

TEST(Markers, OurOwnMotionComesBack) {
  const OwnTake own = own_take(FigureSizes::Ones(), 60);
  const MarkerFit fit = fit_markers(own.take, own.markers, plain_skeleton());
  EXPECT_EQ(fit.up, 'z');
  EXPECT_LT(fit.rms, 1e-3);
  EXPECT_LT(fit.worst, 4e-3);
  EXPECT_LT(worst_centre(own, fit), 8e-3);
  EXPECT_LT((fit.figure.sizes - FigureSizes::Ones()).cwiseAbs().maxCoeff(), 0.02);
}

TEST(Markers, SizesOfThePersonAreFound) {
  FigureSizes sizes;
  sizes << 1.05, 1.02, 0.98, 1.06, 1.0, 1.04, 0.95, 1.02, 1.08, 0.96, 1.04;
  const OwnTake own = own_take(sizes, 60);
  const MarkerFit fit = fit_markers(own.take, own.markers, plain_skeleton());
  EXPECT_LT(fit.rms, 2e-3);
  for (Eigen::Index k = 0; k < sizes.size(); ++k)
    EXPECT_NEAR(fit.figure.sizes[k], sizes[k], 0.025) << kFigureSizes[std::size_t(k)];
  EXPECT_LT(worst_centre(own, fit), 0.012);
}

TEST(Markers, GapsAreBridged) {
  OwnTake own = own_take(FigureSizes::Ones(), 60);
  constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();
  const auto hide = [&](const char* name, int from, int to) {
    const auto found = std::ranges::find(own.take.markers, name) - own.take.markers.begin();
    for (int f = from; f < to; ++f) own.take.frames[std::size_t(f)].row(found).setConstant(kUnseen);
  };
  hide("LKNE", 10, 30), hide("LTIB", 15, 35), hide("RWRA", 0, 8), hide("RASI", 50, 60);
  for (int f = 40; f < 43; ++f) own.take.frames[std::size_t(f)].setConstant(kUnseen);
  const MarkerFit fit = fit_markers(own.take, own.markers, plain_skeleton());
  EXPECT_EQ(fit.blind, 3);
  for (const MarkerResidual& marker : fit.markers)
    if (marker.marker == "LKNE") {
      EXPECT_EQ(marker.gaps, 23);
      EXPECT_EQ(marker.longest, 20);
    }
  EXPECT_LT(worst_centre(own, fit), 0.02);
}

TEST(Markers, DecimalCommasStandBetweenSemicolons) {
  const MarkerTake take = read_markers(kMarkerCorpus / "semicolons.trc");
  EXPECT_NEAR(take.frames[1](0, 1), 1.5105, 1e-9);
  EXPECT_NEAR(take.frames[1](2, 2), -0.21, 1e-9);
}

// Frames that the times leap over are there, unseen; a clock that only trembles has none.
TEST(Markers, TimesThatLeapTellOfLostFrames) {
  const auto take_at = [](const std::vector<int>& places, double tremble) {
    std::string text =
        "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tNumFrames\tNumMarkers\tUnits\n"
        "240\t9\t2\tm\nFrame#\tTime\tA\t\t\tB\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n";
    for (std::size_t f = 0; f < places.size(); ++f)  // times to a millisecond
      text += fmt::format("{}\t{:.3f}\t0\t{}\t0\t0.5\t0\t1\n", f + 1,
                          (places[f] + (f % 2 == 0 ? 0 : tremble)) / 240.0, 0.1 * (places[f] + 1));
    return parse_trc(text, "a.trc", {});
  };
  const MarkerTake lost = take_at({0, 1, 2, 5, 6, 7, 8, 10, 11, 12, 13}, 0);
  EXPECT_EQ(lost.fps, 240);
  ASSERT_EQ(lost.frames.size(), 14u);
  for (std::size_t f = 0; f < 14; ++f) {
    const bool unseen = f == 3 || f == 4 || f == 9;
    EXPECT_EQ(lost.frames[f].array().isNaN().all(), unseen) << f;
    if (!unseen) EXPECT_NEAR(lost.frames[f](0, 1), 0.1 * double(f + 1), 1e-9) << f;
  }
  EXPECT_TRUE(std::ranges::any_of(lost.warnings, [](const std::string& line) {
    return line.find("3 frames") != std::string::npos &&
           line.find("4f to 5f, 10f") != std::string::npos;
  }));
  EXPECT_EQ(take_at({0, 1, 2, 3, 4, 5, 6, 7, 8}, 0).frames.size(), 9u);
  EXPECT_EQ(take_at({0, 1, 2, 3, 5, 6, 7, 8, 9}, 0.4).frames.size(), 9u);
}

TEST(Markers, NamesOfPalpatedPointsAreKnown) {
  const MarkerTables tables = our_tables();
  const std::vector<std::string> markers = {"L_IAS",         "R_FTC", "LFLE",
                                            "subject:R_TAM", "CV7",   "L_HM5"};
  const std::vector<std::string> places = {"asis_l",         "trochanter_r", "knee_lateral_l",
                                           "ankle_medial_r", "cervicale",    "knuckle5_l"};
  const std::vector<const MarkerPlace*> found = find_marker_places(tables, markers);
  for (std::size_t k = 0; k < markers.size(); ++k) {
    ASSERT_NE(found[k], nullptr) << markers[k];
    EXPECT_EQ(found[k]->name, places[k]) << markers[k];
  }
}

TEST(Markers, ATakeWithoutKnownMarkersIsRefused) {
  MarkerTake take = plug_in_names();
  for (std::string& name : take.markers) name = "Q" + name;
  take.frames.assign(3, Points::Random(Eigen::Index(take.markers.size()), 3));
  const Skeleton skeleton = plain_skeleton();
  EXPECT_THROW(fit_markers(take, lay_markers(our_tables(), take, skeleton, {}), skeleton),
               UnfitError);
}

TEST(Markers, ARecordedWalkHasItsPublishedAngles) {
  const fs::path file = kCaptures / "gait2392_subject01_walk1.trc";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
  const MarkerTake take = read_markers(file);
  const Skeleton skeleton = plain_skeleton();
  const MarkerFit fit = fit_markers(take, lay_markers(our_tables(), take, skeleton, {}), skeleton);
  EXPECT_LT(fit.rms, 0.010);
  EXPECT_LT(fit.worst, 0.040);
  std::ifstream stream(kCaptures / "gait2392_subject01_walk1_ik.mot");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const CoordinateTable table = parse_coordinates(text, "walk1_ik.mot");
  for (const auto& [ours, theirs, sign] :
       {std::tuple{"hip_l", "hip_flexion_l", 1}, std::tuple{"hip_r", "hip_flexion_r", 1},
        std::tuple{"knee_l", "knee_angle_l", -1}, std::tuple{"knee_r", "knee_angle_r", -1}}) {
    const std::size_t column =
        std::size_t(std::ranges::find(table.columns, theirs) - table.columns.begin());
    const int j = find_joint(skeleton, ours);
    std::vector<double> a, b;
    double sum = 0;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      const std::size_t f = std::size_t(std::lround(table.times[row] * take.fps));
      if (f >= fit.motion.frames.size()) break;
      a.push_back(joint_angles(skeleton.joints[std::size_t(j)],
                               fit.motion.frames[f].rotations[std::size_t(j)])[0] /
                  kDegree);
      b.push_back(sign * table.rows[row][column]);
      sum += std::pow(a.back() - b.back(), 2);
    }
    EXPECT_GT(correlation(a, b), 0.95) << ours;
    EXPECT_LT(std::sqrt(sum / double(a.size())), 7) << ours;
  }
}
