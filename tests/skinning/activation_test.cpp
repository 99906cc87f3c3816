// Tables of activation: formats, names, and files that are wrong.
#include "skinning/motion/activation_read.h"

#include <gtest/gtest.h>

#include <fstream>

#include "anatomy/errors.h"
#include "skinning/dynamics/distribute_moments.h"

using namespace ecorche;

namespace {

namespace fs = std::filesystem;

Anatomy named_muscles() {
  Anatomy anatomy;
  for (const char* name : {"biceps_brachii_long_l", "biceps_brachii_short_l",
                           "biceps_brachii_long_r", "gastrocnemius_medial_l",
                           "gastrocnemius_medial_r", "soleus_l", "soleus_r", "orbicularis_oris"}) {
    Muscle muscle;
    muscle.name = name;
    anatomy.muscles.push_back(muscle);
  }
  return anatomy;
}

const MuscleAliases kAliases{{"gasmed", "gastrocnemius_medial"},
                             {"BIClong", "biceps_brachii_long"}};

fs::path file_of(const std::string& name, const std::string& text) {
  const fs::path file =
      fs::temp_directory_path() / ("ecorche_activation_" + std::to_string(::getpid()) + "_" + name);
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

std::vector<double> values_at(const std::string& name, const std::string& text, double seconds) {
  const fs::path file = file_of(name, text);
  const Activations read = read_activations(file, named_muscles(), kAliases);
  fs::remove(file);
  std::vector<double> out;
  activation_at(read, seconds, out);
  return out;
}

std::string complaint(const std::string& name, const std::string& text) {
  const fs::path file = file_of(name, text);
  std::string message = "no complaint";
  try {
    read_activations(file, named_muscles(), kAliases);
  } catch (const InputError& e) {
    message = e.what();
  }
  fs::remove(file);
  return message;
}

}  // namespace

TEST(Activation, NamesMeanMuscles) {
  const Anatomy anatomy = named_muscles();
  const auto meant = [&](const char* name) { return muscles_meant(anatomy, name, kAliases); };
  EXPECT_EQ(meant("soleus_l"), (std::vector<int>{5}));
  EXPECT_EQ(meant("soleus"), (std::vector<int>{5, 6}));
  EXPECT_EQ(meant("SOLEUS_R"), (std::vector<int>{6}));
  EXPECT_EQ(meant("biceps_*"), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(meant("biceps_*_l"), (std::vector<int>{0, 1}));
  EXPECT_EQ(meant("*"), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(meant("orbicularis_oris"), (std::vector<int>{7}));
  EXPECT_EQ(meant("/forceset/soleus_r/activation"), (std::vector<int>{6}));
  EXPECT_EQ(meant("soleus_r.activation"), (std::vector<int>{6}));
  EXPECT_EQ(meant("gasmed_r"), (std::vector<int>{4}));
  EXPECT_EQ(meant("r_gasmed"), (std::vector<int>{4}));
  EXPECT_EQ(meant("BIClong"), (std::vector<int>{0, 2}));
  EXPECT_TRUE(meant("soleu").empty());
  EXPECT_TRUE(meant("").empty());
}

TEST(Activation, WideTableIsLinearBetweenItsRowsAndHeldAtItsEnds) {
  const std::string text = "# effort\ntime,soleus_l,biceps_*\n0,0,0.5\n1,1,0.5\n2,0.5,0\n";
  EXPECT_DOUBLE_EQ(values_at("a.csv", text, 0.25)[5], 0.25);
  EXPECT_DOUBLE_EQ(values_at("a.csv", text, 1.5)[5], 0.75);
  EXPECT_DOUBLE_EQ(values_at("a.csv", text, 1.5)[2], 0.25);
  EXPECT_DOUBLE_EQ(values_at("a.csv", text, -3)[1], 0.5);
  EXPECT_DOUBLE_EQ(values_at("a.csv", text, 99)[5], 0.5);
  EXPECT_DOUBLE_EQ(values_at("a.csv", text, 1)[6], 0);
}

TEST(Activation, KeyframesHaveTheirOwnTimes) {
  const std::string text =
      "time,muscle,value\n2,soleus,1\n0,soleus,0\n1,biceps_brachii_long_l,0.4\n";
  const auto at = values_at("k.csv", text, 1);
  EXPECT_DOUBLE_EQ(at[5], 0.5);
  EXPECT_DOUBLE_EQ(at[6], 0.5);
  EXPECT_DOUBLE_EQ(at[0], 0.4);
}

TEST(Activation, TheLargestValueCounts) {
  const auto at = values_at("m.csv", "time,*,soleus_l\n0,0.3,0.8\n", 0);
  EXPECT_DOUBLE_EQ(at[5], 0.8);
  EXPECT_DOUBLE_EQ(at[6], 0.3);
}

TEST(Activation, OpenSimTables) {
  const std::string head = "effort\nversion=1\nnRows=2\nnColumns=3\ninDegrees=no\nendheader\n";
  EXPECT_DOUBLE_EQ(
      values_at("o.sto", head + "time\tsoleus_r\tgasmed_l\n0\t0.1\t0.2\n1\t0.3\t0.6\n", 0.5)[3],
      0.4);
  // Labels that are no activations are left aside, even in unknown words and beyond 1.
  const std::string states = head +
                             "time /jointset/knee/angle/value /forceset/soleus_r/activation "
                             "/forceset/soleus_r/fiber_length\r\n0 77 0.5 -3\r\n";
  EXPECT_DOUBLE_EQ(values_at("s.sto", states, 0)[6], 0.5);
}

TEST(Activation, ComplaintsNameFilePlaceAndWayOut) {
  EXPECT_NE(complaint("x.csv", "time,solaeus_l\n0,0\n").find("soleus_l"), std::string::npos);
  EXPECT_NE(complaint("x.csv", "time,muscle,value\n0,gasmad_l,0\n").find("gasmed_l"),
            std::string::npos);
  EXPECT_NE(complaint("x.csv", "time,soleus\n0,35\n").find("percentages"), std::string::npos);
  EXPECT_NE(complaint("x.csv", "time,soleus\n0,nan\n").find("x.csv"), std::string::npos);
  EXPECT_NE(complaint("x.csv", "time,soleus\n1,0\n1,0\n").find("does not rise"), std::string::npos);
  EXPECT_NE(complaint("x.csv", "seconds,soleus\n1,0\n").find("time"), std::string::npos);
  EXPECT_NE(
      complaint("x.csv", "time,muscle,value\n1,soleus,0\n1,soleus,0.5\n").find("second value"),
      std::string::npos);
  EXPECT_NE(complaint("x.csv", "time,soleus\n").find("no rows"), std::string::npos);
  EXPECT_NE(complaint("x.csv", "time\n0\n").find("no column of a muscle"), std::string::npos);
  EXPECT_NE(complaint("x.sto", "time soleus_l\n0 0\n").find("endheader"), std::string::npos);
  EXPECT_NE(complaint("x.sto", "endheader\n").find("labels"), std::string::npos);
  EXPECT_NE(complaint("x.sto", "endheader\ntime soleus_l soleus_l\n0 0 0\n").find("two columns"),
            std::string::npos);
  EXPECT_NE(complaint("x.sto", "endheader\ntime soleus_l\n0 0 0\n").find("more than"),
            std::string::npos);
  EXPECT_NE(complaint("x.sto", "endheader\ntime soleus_l\n0\n").find("soleus_l"),
            std::string::npos);
  EXPECT_NE(complaint("x.txt", "time,soleus\n0,0\n").find(".csv"), std::string::npos);
}

namespace {

// A hand's weight on a bent arm of two hinges: muscles 0 and 1 bend the first, 2 straightens it, 3
// bends both.
Eigen::MatrixXd arm_moments() {
  Eigen::MatrixXd A(2, 4);
  A << 30, 20, -40, 10, 0, 0, 0, 15;
  return A;
}

}  // namespace

TEST(AutoActivation, GivesTheMomentsByTheLeastSquares) {
  const Eigen::MatrixXd A = arm_moments();
  const Eigen::Vector2d b(12, 3);
  const Eigen::VectorXd a = distribute_moments(A, b, 1e6);
  EXPECT_LT((A * a - b).norm(), 1e-4);
  EXPECT_EQ(a[2], 0);
  // Of the two that bend the first hinge only, each gives in proportion to its arm.
  EXPECT_NEAR(a[0] / a[1], 1.5, 1e-6);
  // No other choice of the same moments has a smaller sum of squares: move along what gives no
  // moment.
  const Eigen::Vector4d still(20, -30, 0, 0);
  for (double step : {-1e-3, 1e-3}) EXPECT_GT((a + step * still).squaredNorm(), a.squaredNorm());
}

TEST(AutoActivation, AsksNobodyForMoreThanAll) {
  const Eigen::VectorXd a = distribute_moments(arm_moments(), Eigen::Vector2d(-100, 0), 1e3);
  EXPECT_EQ(a[2], 1);
  EXPECT_EQ(a[0], 0);
  const Eigen::VectorXd none = distribute_moments(arm_moments(), Eigen::Vector2d(0, 0), 1e3);
  EXPECT_EQ(none.norm(), 0);
}
