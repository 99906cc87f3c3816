#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/base_mesh/skin_import.h"

#include <gtest/gtest.h>

#include "anatomy/errors.h"
#include "tests/body_fixture.h"

namespace ecorche {
namespace {

class BareSkinTest : public BodyFixture {
 protected:
  MeshFile file_of(const Points& V, const Triangles& F) const { return {{{"skin", {V, F}}}, {}}; }
  Points base() const { return package().points.topRows(package().skin_size); }

  // The base skin as read back should be: on the floor.
  Points grounded() const {
    Points out = base();
    out.col(1).array() -= out.col(1).minCoeff();
    return out;
  }
};

TEST_F(BareSkinTest, UnitsAndAxesAreFoundOut) {
  struct Case {
    double per_metre;
    Mat3 turn;
    const char *up, *front;
    bool mirrored;
  };
  Mat3 z_up, sideways, left_handed;
  z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  sideways << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  left_handed << 1, 0, 0, 0, 1, 0, 0, 0, -1;
  const Case cases[] = {{1, Mat3::Identity(), "+Y", "+Z", false},
                        {10, z_up, "+Z", "-Y", false},
                        {100, sideways, "+X", "+Y", false},
                        {1000, z_up, "+Z", "-Y", false},
                        {1, left_handed, "+Y", "-Z", true}};
  for (const auto& c : cases) {
    Points V = c.per_metre * base() * c.turn.transpose();
    V.rowwise() += Eigen::RowVector3d(3, -40, 1234);
    Triangles F = package().triangles;
    if (c.mirrored) F.col(1).swap(F.col(2));
    const BareSkin read = bare_skin(file_of(V, F), "somebody.obj", package());
    EXPECT_NEAR(read.unit, 1 / c.per_metre, 1e-12);
    EXPECT_EQ(read.up, c.up);
    EXPECT_EQ(read.front, c.front);
    EXPECT_EQ(read.mirrored, c.mirrored);
    EXPECT_LT((read.body.skin.V - grounded()).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_FALSE(read.notes.empty());
  }
}

TEST_F(BareSkinTest, ObliqueAxesAreTurnedBack) {
  const Mat3 turn = (Eigen::AngleAxisd(0.7, Vec3::UnitY()) * Eigen::AngleAxisd(0.4, Vec3::UnitX()))
                        .toRotationMatrix();
  const BareSkin read =
      bare_skin(file_of(base() * turn.transpose(), package().triangles), "turned.obj", package());
  EXPECT_EQ(read.up, "oblique");
  EXPECT_LT((read.body.skin.V - grounded()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(BareSkinTest, SeamsOfATextureAreWelded) {
  // Every fifth triangle has corners of its own: copies after all vertices, or each beside its
  // vertex.
  const Points V = base();
  const Triangles& F = package().triangles;
  std::vector<std::pair<int, int>> copies;  // vertex, corner
  for (int corner = 0; corner < 3 * F.rows(); corner += 15)
    copies.emplace_back(F(corner / 3, corner % 3), corner);
  for (const bool beside : {false, true}) {
    std::vector<int> rows, first(std::size_t(V.rows()));  // vertex of each row
    std::vector<int> own(3 * F.rows(), -1);               // row of a corner that has its own
    std::vector<std::vector<int>> of_vertex(V.rows());
    for (const auto& [vertex, corner] : copies) of_vertex[vertex].push_back(corner);
    const auto add_copies = [&](int v) {
      for (const int corner : of_vertex[v]) own[corner] = int(rows.size()), rows.push_back(v);
    };
    for (int v = 0; v < V.rows(); ++v) {
      first[v] = rows.size();
      rows.push_back(v);
      if (beside) add_copies(v);
    }
    if (!beside)
      for (int v = 0; v < V.rows(); ++v) add_copies(v);
    Points split(rows.size(), 3);
    for (std::size_t r = 0; r < rows.size(); ++r) split.row(r) = V.row(rows[r]);
    Triangles corners(F.rows(), 3);
    for (int corner = 0; corner < 3 * F.rows(); ++corner) {
      const int copy = own[corner];
      corners(corner / 3, corner % 3) = copy >= 0 ? copy : first[F(corner / 3, corner % 3)];
    }
    const BareSkin read = bare_skin(file_of(split, corners), "split.glb", package());
    EXPECT_EQ(read.body.skin.V.rows(), package().skin_size);
    EXPECT_LT((read.body.skin.V - grounded()).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_TRUE(!beside || read.notes.front().find("seams") != std::string::npos)
        << read.notes.front();
  }
}

TEST_F(BareSkinTest, HelperGeometryIsKept) {
  const BareSkin read =
      bare_skin(file_of(package().points, package().triangles), "full.obj", package());
  EXPECT_EQ(read.points.rows(), package().points.rows());
  EXPECT_EQ(read.body.skin.V.rows(), package().skin_size);
}

TEST_F(BareSkinTest, TheSkinIsFoundAmongOtherMeshes) {
  MeshFile file = file_of(base(), package().triangles);
  file.parts.insert(file.parts.begin(), {"shoe", {Points::Random(50, 3), Triangles::Zero(1, 3)}});
  EXPECT_EQ(bare_skin(file, "clothed.glb", package()).body.skin.V.rows(), package().skin_size);
}

std::string message_of(const MeshFile& file, const BodyPackage& package) {
  try {
    bare_skin(file, "wrong.obj", package);
  } catch (const UnfitError& e) {
    return e.what();
  }
  return "accepted";
}

TEST_F(BareSkinTest, OtherMeshesAreRefusedWithTheirCounts) {
  const Points few = base().topRows(13000);
  Triangles F = package().triangles;
  F = F.unaryExpr([](int i) { return std::min(i, 12999); });
  EXPECT_NE(
      message_of(file_of(few, F), package()).find("13000 vertices; the base mesh's skin has 13380"),
      std::string::npos);
  const Points reversed = base().colwise().reverse();
  const Triangles G = (package().skin_size - 1 - package().triangles.array()).matrix();
  EXPECT_NE(message_of(file_of(reversed, G), package()).find("% of the base mesh's edges"),
            std::string::npos);
  EXPECT_NE(
      message_of(file_of(17 * base(), package().triangles), package()).find("no human height"),
      std::string::npos);
  EXPECT_NE(message_of(file_of(0 * base(), package().triangles), package()).find("one point"),
            std::string::npos);
}

TEST_F(BareSkinTest, InchesAreAskedForAndTaken) {
  const double stature = base().col(1).maxCoeff() - base().col(1).minCoeff();
  const MeshFile inches = file_of(base() * (1.75 / stature / 0.0254), package().triangles);
  EXPECT_NE(message_of(inches, package()).find("say --unit cm or --unit in"), std::string::npos);
  const BareSkin read = bare_skin(inches, "inches.obj", package(), metres_in("in"));
  EXPECT_NEAR(read.body.skin.V.col(1).maxCoeff(), 1.75, 1e-6);
  EXPECT_THROW(bare_skin(inches, "inches.obj", package(), metres_in("mm")), UnfitError);
  EXPECT_FALSE(metres_in("furlong").has_value());
}

TEST_F(BareSkinTest, TwoPeopleInOneFileAreRefused) {
  const Points one = base();
  Points V(2 * one.rows(), 3);
  V << one, one.rowwise() + Eigen::RowVector3d(1.5, 0, 0);
  const Triangles& first = package().triangles;
  Triangles F(2 * first.rows(), 3);
  F << first, (first.array() + int(one.rows())).matrix();
  EXPECT_NE(message_of(file_of(V, F), package()).find("two skins"), std::string::npos);
}

TEST_F(BareSkinTest, ACrumpledSurfaceIsRefused) {
  Points V = base();
  std::srand(5);
  const double stature = V.col(1).maxCoeff() - V.col(1).minCoeff();
  V += 0.012 * stature * Points::Random(V.rows(), 3);
  EXPECT_NE(message_of(file_of(V, package().triangles), package()).find("crumpled"),
            std::string::npos);
}

TEST_F(BareSkinTest, RaisedArmsAreRefused) {
  const auto parts = vertex_parts(package());
  Points V = base();
  const Vec3 shoulder(0.17, 0.50, -0.02);
  const Mat3 raise = Eigen::AngleAxisd(0.8, Vec3::UnitZ()).toRotationMatrix();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool arm = parts[i].part == BodyPart::upper_arm || parts[i].part == BodyPart::forearm ||
                     parts[i].part == BodyPart::hand;
    if (!arm || parts[i].side != Side::left) continue;
    const Eigen::Index row = i;
    V.row(row) = (shoulder + raise * (Vec3(V.row(row)) - shoulder)).transpose();
  }
  EXPECT_NE(message_of(file_of(V, package().triangles), package()).find("left upper arm"),
            std::string::npos);
}

}  // namespace
}  // namespace ecorche
