#include "app/pages/demo_pictures.h"

#include "anatomy/base_mesh/eyes.h"
#include "app/pages/stage_pictures.h"

namespace ecorche {

Picture picture_of_fit(const Template& body_template, const Body& body, const FittedActor& fitted,
                       const BodyPackage& package, const std::string& caption) {
  const Anatomy& anatomy = fitted.actor.character.anatomy;
  Look skin, bones_in_glass, all_in_glass, flayed;
  skin.muscles = skin.bones = 0;
  bones_in_glass.skin = all_in_glass.skin = 0.10f;
  bones_in_glass.skin_edge = all_in_glass.skin_edge = 0.45f;
  bones_in_glass.muscles = 0;
  flayed.skin = 0;
  const Stage stages[] = {{&anatomy, skin, "(a) skin"},
                          {&body_template.anatomy, all_in_glass, "(b) template in it"},
                          {&anatomy, bones_in_glass, "(c) bones fitted"},
                          {&fitted.undilated, all_in_glass, "(d) muscles shrunk"},
                          {&anatomy, all_in_glass, "(e) muscles dilated"},
                          {&anatomy, flayed, "the écorché"}};
  const std::string views[] = {"front", "left", "back"};
  Renderer renderer;
  return {encode_png(sheet_of_stages(renderer, body.skin,
                                     find_eyes(package, body.skin, anatomy.skeleton), stages, views,
                                     300, 420)),
          caption};
}

Picture picture_of_muscles(const FittedActor& fitted, const BodyPackage& package) {
  const Character& character = fitted.actor.character;
  Renderer renderer;
  return {encode_png(plate_of_muscles(
              renderer, character.anatomy, character.body.skin,
              find_eyes(package, character.body.skin, character.anatomy.skeleton), 940)),
          "The muscles that are seen largest from before and behind (the paper's figure 2)"};
}

Picture picture_of_jump(const Actor& actor, const BodyPackage& package, const Motion& jump,
                        const DemoRecord& record) {
  const double takeoff = record.events[0].first, highest = record.events[1].first,
               landing = record.events[2].first;
  const std::vector<double> moments{takeoff - 1.2,
                                    takeoff - 0.45,
                                    takeoff - 0.12,
                                    takeoff,
                                    0.5 * (takeoff + highest),
                                    highest,
                                    0.5 * (highest + landing),
                                    landing + 0.05};
  Renderer renderer;
  const auto eyes = find_eyes(package, actor.character.body.skin, actor.character.anatomy.skeleton);
  return {encode_png(sheet_of_moments(renderer, actor, eyes, jump, moments)),
          "Run-up, take-off, flight and landing: the skin, and the muscles that move it, coloured "
          "by their lengths (figure 6)"};
}

Picture picture_of_walk(const Actor& actor, const BodyPackage& package, const Motion& walk) {
  std::vector<double> moments;
  const double end = double(walk.frames.size() - 1) / walk.fps;
  for (int i = 0; i < 8; ++i) moments.push_back(0.5 * end + 0.15 * i);
  Renderer renderer;
  const auto eyes = find_eyes(package, actor.character.body.skin, actor.character.anatomy.skeleton);
  return {encode_png(sheet_of_moments(renderer, actor, eyes, walk, moments, {.flayed = false})),
          "The skin walking (figure 7)"};
}

}  // namespace ecorche
