// The subject of the window: a character with a motion, or with sliders for its measurements.
// Other files can be opened while it is displayed.
#pragma once

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/common_options.h"
#include "app/files/actor.h"
#include "app/options/motion_options.h"
#include "app/report.h"
#include "app/studio/body_sliders.h"
#include "skinning/dynamics/soft_tissue.h"
#include "viewer/window/view_document.h"

namespace ecorche {

struct ViewSessionOptions {
  std::filesystem::path
      character;  // the template in its own body, or an average one of `sex`, when empty
  std::filesystem::path motion;         // none when empty
  std::filesystem::path body_template;  // that sliders fit with; the built-in one when empty
  std::string sex;                      // "male", "female" or empty
  bool sliders = false, dynamics = false;
  std::vector<std::string> measures;  // that sliders begin with
  std::optional<double> definition;   // ActorOptions
  MotionOptions retarget;
};

class ViewSession {
 public:
  // Throws as the readers of characters and motions do. All are borrowed.
  ViewSession(const ViewSessionOptions& options, const Common& common, Report& report);
  ~ViewSession();
  ViewSession(const ViewSession&) = delete;
  ViewSession& operator=(const ViewSession&) = delete;

  const ViewSubject& subject() const { return subject_; }
  // Initial document of the window.
  ViewDocument document() const;

  // Writes the character of the sliders' last targets and notes missed accuracy targets. Returns
  // 0, or 8 if one is missed. Throws as BodySliders::write.
  int write(const ViewDocument& document, const std::filesystem::path& file);
  // 8 if something was written in the window that misses a target, else 0.
  int exit_code() const { return exit_code_; }

 private:
  // A character and its motion.
  struct Performance {
    std::shared_ptr<const Actor> actor;
    Motion motion;
    SceneModel model;
    SoftTissueTables flesh;
    std::filesystem::path character, moved_by;
  };
  // Result of a job in the background.
  struct Done {
    std::shared_ptr<Performance> performance;
    std::shared_ptr<BodySliders> sliders;
    std::filesystem::path character;  // of the sliders
    std::string message;
    int exit_code = 0;
  };

  Character open_start(const std::filesystem::path& file, bool moves, std::optional<Actor>& actor,
                       Report& report) const;
  std::shared_ptr<Performance> perform(std::shared_ptr<const Actor> actor,
                                       const std::filesystem::path& character,
                                       const std::filesystem::path& motion, Report& report) const;
  Done open_file(const std::filesystem::path& file,
                 const std::shared_ptr<const Performance>& before) const;
  Done save_file(const std::filesystem::path& file,
                 const std::vector<std::optional<double>>& asked) const;
  void begin(const std::string& state, std::function<Done()> job);
  void update(ViewDocument& document, bool wait);
  void take_job(ViewDocument& document);
  void take_sliders(ViewDocument& document, bool wait);
  void show_performance();
  void show_slid();
  void pose(int frame, PosedAnatomy& posed, SkinFrame& skin);

  const ViewSessionOptions& options_;
  const Common& common_;
  Report& report_;
  ViewSubject subject_;
  std::shared_ptr<const Performance> performance_;
  std::shared_ptr<BodySliders> sliders_;
  std::shared_ptr<const SlidBody> slid_;
  std::filesystem::path slid_file_;
  std::vector<std::optional<double>> asked_;
  std::optional<ActorState> played_;  // of the performance
  SoftTissueState soft_tissue_;
  std::string job_state_;
  int exit_code_ = 0;
  std::future<Done> job_;  // last: it uses the above
};

}  // namespace ecorche
