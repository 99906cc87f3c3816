// The body fitted anew for the newest document, in a thread of its own.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/character.h"
#include "app/common_options.h"
#include "app/edit/document/document.h"
#include "app/edit/session.h"
#include "app/files/actor.h"
#include "morph/fit/fit_anatomy.h"
#include "viewer/scene.h"

namespace ecorche {

// What the window shows: a character, the document that it was made for, and the motion that it
// plays.
struct ShownBody {
  Document of;
  std::shared_ptr<const Actor> actor;        // null: not bound yet, it only stands
  std::shared_ptr<const Character> unbound;  // where there is no actor
  std::shared_ptr<const SceneModel> model;
  std::shared_ptr<const Motion> motion;  // one frame at least
  std::filesystem::path motion_file;     // empty: it stands
  double fit_seconds = 0;                // that it took
  double fit_cpu_seconds = 0;            // of the whole program's CPU time meanwhile
  std::vector<LandmarkDepth> landmarks;  // palpable points of its bones

  const Character& character() const { return actor ? actor->character : *unbound; }
};

// The template as it is built, before anything is fitted.
std::shared_ptr<const ShownBody> unfitted_body(const Assets& assets, const Template& base,
                                               const Document& document);

class BackgroundFit {
 public:
  // `built_in`: of the workshop whose documents are asked for.
  BackgroundFit(const Common& common, const Document& built_in,
                std::shared_ptr<const ShownBody> first, Session::Drawer draw = {});
  ~BackgroundFit();
  BackgroundFit(const BackgroundFit&) = delete;
  BackgroundFit& operator=(const BackgroundFit&) = delete;

  // Begins with it, unless it is what is shown or being made. A body that was made before is shown
  // at once. `again`: also what was cancelled.
  void ask(const Document& document, bool again = false);
  void cancel();  // what runs is not shown any more; nothing begins before the next ask()
  // Runs an action that leaves the document alone and takes long (write_character, render): what it
  // says comes with take_message(). `other`: what the document is compared with.
  void run_beside(const Document& document, const std::optional<Document>& other,
                  const std::string& line);

  std::shared_ptr<const ShownBody> newest() const;
  bool busy() const;
  bool is_cancelled() const;
  // What is being done, with the share of its time that has gone by, by how long it took before.
  std::string stage() const;
  double share() const;
  std::string problem() const;  // why the document has no body; empty: it has
  // Of a line of run_beside that has ended; without text: none has.
  struct Said {
    std::string text;
    bool failed = false;
  };
  Said take_message();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche
