// The figure in a window: posed, drawn as well as the driver can in the time there is, and kept.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "viewer/cut_faces.h"
#include "viewer/gl/gl_api.h"
#include "viewer/gl/gl_targets.h"
#include "viewer/gl/renderer.h"
#include "viewer/gl/window_copies.h"
#include "viewer/organ_rooms.h"
#include "viewer/scene.h"
#include "viewer/window/view_document.h"
#include "viewer/window/window_tool.h"

namespace ecorche {

class FigureView {
 public:
  // Both borrowed. Draws with the context that is current in this thread.
  FigureView(const ViewSubject& subject, const WindowTool& tool, Renderer::GetProc get_proc);

  // Posed once for each frame of each subject.
  const PosedAnatomy& pose(const ViewDocument& document);
  Camera camera(const ViewDocument& document, const ViewRoom& room, float width, float height);

  struct Size {
    int width = 1, height = 1;  // of the window, pixels
    float unit = 1;             // pixels of a unit of the room
    ViewRoom room{};            // in units
    bool over = false;          // what another figure has drawn beside it stays
  };
  // moving: quickly, where the driver is slow; still: as well as a job leaves time for.
  enum class Wish { moving, still, finest };
  // Into the window. A picture that has not changed is copied, so that panels and jobs do not wait
  // for it.
  void draw(const ViewDocument& document, const Camera& camera, const Size& size, Wish wish);
  // What the frame took, in which it was drawn. Where what moves takes too long, it is drawn
  // quickly from then on.
  void took(double seconds);

  // Rooms of organs that the last picture has cut.
  std::vector<FacePlace> cut_rooms() const;
  std::uint32_t part_at(float x, float y);  // pixels of the window, from the upper left

 private:
  // coarse, at half the size; coarse; with shadows; with fine edges and occlusion
  enum class Detail { half, quick, plain, fine };
  Detail detail_for(Wish wish, bool busy) const;
  // A scene of the subject's model, or of its coarse one.
  struct Shown {
    Scene scene;
    std::optional<Appearance> drawn;  // of the scene as it is
  };
  void bring_up(const SceneModel& model, const PosedAnatomy& posed, const Appearance& appearance,
                Shown& shown);
  void render(const PosedAnatomy& posed, const Appearance& appearance, const ViewDocument& document,
              Shown& shown);
  // The scene with what the tool adds, as `use` sees it.
  template <class Use>
  void with_tool(const PosedAnatomy& posed, const Appearance& appearance, DrawList& list,
                 const Use& use);
  void cut(const ViewDocument& document, const PosedAnatomy& posed, const Appearance& appearance,
           DrawList& list);
  void show(const Size& size, bool again);
  bool same_camera(const Camera& camera) const;

  const ViewSubject& subject_;
  const WindowTool& tool_;
  Renderer renderer_;
  GlApi gl_;
  GlTarget kept_{gl_, {GL_RGBA8}, false};  // the picture, without panels
  GlTarget store_{gl_, {GL_RGBA}, false};  // the window's pixels of it, where it is seen again
  bool stored_ = false;
  Detail detail_ = Detail::plain;
  bool slow_ = false, rendered_ = false;
  int first_column_ = 0, columns_ = 0;  // of the kept picture, that were drawn
  float share_ = 1;                     // of the window's pixels
  std::uint64_t touched_ = 0;
  Shown fine_, coarse_;
  Camera camera_;  // of the kept picture
  bool ground_ = false;
  PosedAnatomy posed_;
  SkinFrame skin_;
  std::vector<float> activity_;
  std::optional<Appearance> pictured_;  // that the kept picture has
  SectionPlane section_;                // that was drawn
  std::optional<Vec4f> cut_;            // the plane of faces_
  DrawMesh faces_;
  std::vector<OrganRoom> rooms_;
  std::uint64_t rooms_of_ = 0;  // SceneModel::number
  std::uint64_t revision_ = 0, known_ = 0;
  int frame_ = -1;
};

}  // namespace ecorche
