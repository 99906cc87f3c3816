// Characters that documents are tried on: fitted and compiled once for each document that needs
// another, and posed as its trial says.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/character.h"
#include "app/common_options.h"
#include "app/edit/comparison.h"
#include "app/edit/document/workshop.h"
#include "app/files/actor.h"
#include "app/report.h"
#include "morph/fit/fit_anatomy.h"
#include "skinning/motion/activation.h"

namespace ecorche {

// Borrowed until the next document is tried.
struct TriedBody {
  const Actor* actor = nullptr;
  Motion motion;
  Activations activations;
};

// What a picture or a film is taken of.
struct Tried {
  TriedBody own;
  std::optional<TriedBody> other;  // where the document is compared
  Comparison comparison;
  ComparedNames names;
  double moment = 0;   // of the motion
  std::string picked;  // muscle, without side
};

class TriedBodies {
 public:
  // All borrowed.
  TriedBodies(Workshop& workshop, const Common& common, Report& report)
      : workshop_(workshop), common_(common), report_(report) {}

  // The document's body with its muscles, fitted.
  const Character& fitted(const Document& document);
  // Palpable points of the last document that was fitted.
  const std::vector<LandmarkDepth>& landmarks() const { return own_.landmarks; }
  const Actor& actor(const Document& document);
  // The document's motion, with the joints that its trial turns; at rest where it has none.
  Motion motion(const Document& document, const Actor& actor);
  // Its pose at the moment of its trial, alone.
  Motion still(const Document& document, const Actor& actor);
  // `other`: of a comparison with another document. `moves`: the whole motion; else a still.
  Tried tried(const Document& document, const std::optional<Document>& other, bool moves);

 private:
  struct Made {
    std::optional<Document> of, acted;
    std::optional<Character> character;
    std::vector<LandmarkDepth> landmarks;
    std::unique_ptr<Actor> actor;
  };
  const Character& fitted(const Document& document, Made& made);
  const Actor& actor(const Document& document, Made& made);
  TriedBody body(const Document& document, const Actor& actor, bool moves);

  Workshop& workshop_;
  const Common& common_;
  Report& report_;
  Made own_, other_;
  std::unique_ptr<Actor> skinned_;  // the document's own body with another skin
};

}  // namespace ecorche
