// Names on a plate: each stands where its part is seen, parts that are hidden have none, and no
// name lies over another.
#include "viewer/plate_labels.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/viewer/balls.h"
#include "viewer/camera.h"
#include "viewer/lettering.h"

namespace ecorche {
namespace {

// Balls about the origin, seen from the front.
DrawList balls(std::initializer_list<DrawItem> items) {
  DrawList list;
  list.meshes.push_back(sphere(24));
  list.items = items;
  list.camera = orbit_camera(Vec3f::Zero(), 3, 0, 0, 0.35f, 1.5f);
  return list;
}

TEST(PlateLabels, APartIsNamedWhereMostOfItIsSeen) {
  const std::uint32_t parts[] = {1, 2, 3};
  const DrawList list = balls({ball({1, 0, 0}, 1, {-1.5f, 0, 0}), ball({0, 1, 0}, 2, {1.5f, 0, 0}),
                               ball({0, 0, 1}, 3, {1.5f, 0, -3}, 0.5f)});
  const std::vector<PartPlace> seen = seen_places(list, 1.5f, parts);
  ASSERT_EQ(seen.size(), 2u) << "the third lies behind the second";
  EXPECT_EQ(seen[0].part, 1u);
  EXPECT_NEAR(seen[0].y, 0.5, 0.02);
  EXPECT_NEAR(seen[0].x, 1 - seen[1].x, 0.02);
  EXPECT_LT(seen[0].x, 0.5);
  EXPECT_GT(seen[0].pixels, 1000);
}

TEST(PlateLabels, GlassHidesNothingAndACutTakesAway) {
  const std::uint32_t parts[] = {1, 2};
  DrawList list = balls({ball({1, 0, 0}, 1, {0, 0, 0}, 1.2f), ball({0, 1, 0}, 2, {0, 0, 0}, 0.8f)});
  EXPECT_EQ(seen_places(list, 1.5f, parts).front().part, 1u);
  list.items[0].surface.opacity = 0.2f;
  EXPECT_EQ(seen_places(list, 1.5f, parts).front().part, 2u);
  list.items[0].surface.opacity = 1;
  list.cut = Vec4f(0, 0, 1, -2);  // all lies on the eye's side of it
  EXPECT_TRUE(seen_places(list, 1.5f, parts).empty());
}

TEST(PlateLabels, BothSidesOfAPartHaveOneName) {
  Anatomy anatomy;
  for (const char* name : {"soleus_l", "soleus_r"}) {
    Muscle& muscle = anatomy.muscles.emplace_back();
    muscle.name = name;
    muscle.label = "soleus";
    muscle.side = name[7] == 'l' ? Side::left : Side::right;
  }
  const PartPlace places[] = {{100000, 0.2f, 0.5f, 40}, {100001, 0.7f, 0.5f, 90}};
  const std::vector<PlateLabel> labels = plate_labels(anatomy, places);
  ASSERT_EQ(labels.size(), 1u);
  EXPECT_FLOAT_EQ(labels[0].x, 0.7f);
  EXPECT_EQ(labels[0].text.find("right"), std::string::npos);
}

// Rows of the picture's edge that have ink.
std::vector<int> inked_rows(const Image& picture, int from, int to) {
  std::vector<int> out;
  for (int y = 0; y < picture.height; ++y)
    for (int x = from; x < to; ++x)
      if (picture.pixel(x, y)[0] < 128) {
        out.push_back(y);
        break;
      }
  return out;
}

TEST(PlateLabels, NoNameLiesOverAnotherHoweverManyPointToOnePlace) {
  if (text_width("a", 20) == 0) GTEST_SKIP() << "no font";
  Image picture = make_image(800, 400);
  std::vector<PlateLabel> labels;
  for (int k = 0; k < 24; ++k) labels.push_back({"muscle", 0.5f, 0.5f});
  draw_labels(picture, labels);
  for (const auto& [from, to] : {std::pair{0, 60}, std::pair{740, 800}}) {
    const std::vector<int> rows = inked_rows(picture, from, to);
    int words = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) words += k == 0 || rows[k] > rows[k - 1] + 1;
    EXPECT_EQ(words, 12);
    EXPECT_GT(rows.front(), 0);
    EXPECT_LT(rows.back(), 399);
  }
}

}  // namespace
}  // namespace ecorche
