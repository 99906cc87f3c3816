#include "app/edit/tried_bodies.h"

#include <utility>

#include "app/edit/refit.h"
#include "app/edit/trial_pose.h"
#include "app/files/open_motion.h"
#include "skinning/motion/sample_motion.h"

namespace ecorche {

const Character& TriedBodies::fitted(const Document& document) { return fitted(document, own_); }

const Character& TriedBodies::fitted(const Document& document, Made& made) {
  if (made.character && fits_alike(*made.of, document)) return *made.character;
  const StageTimer timer(report_, "refit");
  const Body body = edited_body(workshop_, document, common_, report_);
  FittedCharacter fitted = fit_character(edited_template(workshop_, document), body,
                                         workshop_.package(), fitting_of(document));
  made.landmarks = std::move(fitted.report.fit.landmarks);
  made.character = Character{std::move(fitted.anatomy), body};
  made.of = document;
  return *made.character;
}

const Actor& TriedBodies::actor(const Document& document) { return actor(document, own_); }

const Actor& TriedBodies::actor(const Document& document, Made& made) {
  if (made.actor && fits_alike(*made.acted, document)) return *made.actor;
  made.actor = std::make_unique<Actor>(
      make_actor(common_.assets, fitted(document, made), report_, {.refinement = true}));
  made.acted = document;
  return *made.actor;
}

Motion TriedBodies::motion(const Document& document, const Actor& actor) {
  const Skeleton& skeleton = actor.character.anatomy.skeleton;
  const Trial& trial = *document.trial;
  Motion out;
  if (trial.motion.empty())
    out.frames.push_back(rest_pose(skeleton));
  else
    out = open_motion(trial.motion, actor, MotionOptions{}, common_, report_);
  for (Pose& pose : out.frames) pose = trial_pose(workshop_, document, skeleton, pose);
  return out;
}

Motion TriedBodies::still(const Document& document, const Actor& actor) {
  const Skeleton& skeleton = actor.character.anatomy.skeleton;
  const Trial& trial = *document.trial;
  Pose start = rest_pose(skeleton);
  if (!trial.motion.empty())
    pose_at(open_motion(trial.motion, actor, MotionOptions{}, common_, report_), trial.seconds,
            start);
  Motion out;
  out.frames.push_back(trial_pose(workshop_, document, skeleton, start));
  return out;
}

TriedBody TriedBodies::body(const Document& document, const Actor& actor, bool moves) {
  const Anatomy& anatomy = actor.character.anatomy;
  if (moves && !document.trial->motion.empty())
    return {&actor, motion(document, actor), trial_activations(document, anatomy)};
  TriedBody out{&actor, still(document, actor), {int(anatomy.muscles.size()), {}}};
  const std::vector<double> values = trial_activation(document, anatomy, document.trial->seconds);
  for (int m = 0; m < int(values.size()); ++m)
    if (values[std::size_t(m)] > 0)
      out.activations.curves.push_back({{m}, {0}, {values[std::size_t(m)]}});
  return out;
}

Tried TriedBodies::tried(const Document& document, const std::optional<Document>& other,
                         bool moves) {
  const Trial& trial = *document.trial;
  Tried out{body(document, actor(document), moves),
            {},
            trial.comparison,
            compared_names(document),
            moves && !trial.motion.empty() ? trial.seconds : 0,
            document.picked};
  if (const ComparedSkin* skin = compared_skin(trial.comparison.with)) {
    skinned_ = std::make_unique<Actor>(make_actor(common_.assets, fitted(document), report_));
    choose_skin(common_.assets, *skinned_, skin->method);
    out.other = TriedBody{skinned_.get(), out.own.motion, out.own.activations};
  } else if (other) {
    out.other = body(*other, actor(*other, other_), moves);
  }
  return out;
}

}  // namespace ecorche
