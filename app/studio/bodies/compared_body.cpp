#include "app/studio/bodies/compared_body.h"

#include <chrono>
#include <utility>

namespace ecorche {
namespace {

bool is_done(const std::future<std::shared_ptr<const ShownBody>>& made) {
  return made.valid() && made.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

// The body with another skin over its bones.
std::shared_ptr<const ShownBody> with_skin(const Assets& assets, const ShownBody& body,
                                           const char* method) {
  auto actor = std::make_shared<Actor>(*body.actor);
  choose_skin(assets, *actor, method);
  auto out = std::make_shared<ShownBody>(body);
  out->actor = std::move(actor);
  return out;
}

}  // namespace

ComparedBody::ComparedBody(const Common& common, const Document& built_in,
                           std::shared_ptr<const ShownBody> first)
    : common_(common), built_in_(built_in), first_(std::move(first)) {}

ComparedBody::~ComparedBody() = default;

bool ComparedBody::busy() const { return skinned_.valid() || (fit_ && fit_->busy()); }

void ComparedBody::show(std::shared_ptr<const ShownBody> body) {
  if (body == shown_) return;
  state_.reset();
  shown_ = std::move(body);
  if (shown_ && shown_->actor) state_.emplace(*shown_->actor);
  ++revision_;
}

void ComparedBody::update_skin(const ComparedSkin& skin,
                               const std::shared_ptr<const ShownBody>& own) {
  if (is_done(skinned_)) {
    try {
      show(skinned_.get());
    } catch (const std::exception& error) {
      problem_ = error.what();
      show(nullptr);
    }
  }
  if (!own->actor || skinned_.valid() || (skin_ == skin.name && skinned_of_ == own)) return;
  skin_ = skin.name;
  skinned_of_ = own;
  skinned_ = std::async(std::launch::async, [assets = common_.assets, own, method = skin.method] {
    return with_skin(assets, *own, method);
  });
}

void ComparedBody::update(const Document& seen, const std::optional<Document>& other,
                          const std::shared_ptr<const ShownBody>& own) {
  const std::string& with = seen.trial->comparison.with;
  problem_.clear();
  if (const ComparedSkin* skin = compared_skin(with)) {
    update_skin(*skin, own);
  } else {
    skin_.clear();
    skinned_of_.reset();
    if (other) {
      if (!fit_) fit_ = std::make_unique<BackgroundFit>(common_, built_in_, first_);
      fit_->ask(*other);
      problem_ = fit_->problem();
      const std::shared_ptr<const ShownBody> newest = fit_->newest();
      show(newest->actor && problem_.empty() ? newest : nullptr);
    } else {
      show(nullptr);
      if (!with.empty()) problem_ = "nothing was edited before that changes the body";
    }
  }
  if (seen.trial == trial_) return;
  trial_ = seen.trial;
  ++revision_;
}

void ComparedBody::pose(Workshop& workshop, const Document& seen, int frame, PosedAnatomy& posed,
                        SkinFrame& skin) {
  evaluate_tried(*shown_->actor, tried_frame(workshop, seen, *shown_, frame), false, *state_, posed,
                 skin);
}

}  // namespace ecorche
