// The figure that the shown one is compared with: another skin of the same body, or the body of
// another document. Made in threads of its own, posed in the same trial.
#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "app/common_options.h"
#include "app/edit/comparison.h"
#include "app/files/actor.h"
#include "app/studio/bodies/background_fit.h"
#include "app/studio/bodies/posed_body.h"

namespace ecorche {

class ComparedBody {
 public:
  // `common` is borrowed; the others as of BackgroundFit.
  ComparedBody(const Common& common, const Document& built_in,
               std::shared_ptr<const ShownBody> first);
  ~ComparedBody();

  // Takes over what was made and begins what is wanted: once a frame. `seen`: whose comparison it
  // is; `other`: the document it is compared with, where that is one; `own`: what is shown of it.
  void update(const Document& seen, const std::optional<Document>& other,
              const std::shared_ptr<const ShownBody>& own);
  // The figure to show; null: there is none, or it is still being made.
  const ShownBody* shown() const { return shown_.get(); }
  bool busy() const;
  // Why there is nothing to compare with; empty: there is, or nothing is wanted.
  const std::string& problem() const { return problem_; }
  // A new value: another figure, or another trial.
  std::uint64_t revision() const { return revision_; }

  // In a frame of the motion, in the trial of the last update(). Precondition: shown().
  void pose(Workshop& workshop, const Document& seen, int frame, PosedAnatomy& posed,
            SkinFrame& skin);

 private:
  void show(std::shared_ptr<const ShownBody> body);
  void update_skin(const ComparedSkin& skin, const std::shared_ptr<const ShownBody>& own);

  const Common& common_;
  const Document built_in_;
  std::shared_ptr<const ShownBody> first_;
  std::unique_ptr<BackgroundFit> fit_;  // from the first comparison with a document on
  std::future<std::shared_ptr<const ShownBody>> skinned_;
  std::shared_ptr<const ShownBody> skinned_of_;
  std::string skin_;  // that is shown or being made, by name
  std::shared_ptr<const ShownBody> shown_;
  std::optional<ActorState> state_;
  Shared<Trial> trial_;
  std::string problem_;
  std::uint64_t revision_ = 1;
};

}  // namespace ecorche
