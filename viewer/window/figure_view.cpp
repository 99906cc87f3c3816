#include "viewer/window/figure_view.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ecorche {
namespace {

constexpr double kSlow = 0.025;  // s, of a picture of what moves
constexpr float kBeside[4] = {0.13f, 0.13f, 0.14f, 1};

}  // namespace

FigureView::FigureView(const ViewSubject& subject, const WindowTool& tool,
                       Renderer::GetProc get_proc)
    : subject_(subject), tool_(tool), renderer_(RenderOptions{}, get_proc), gl_(load_gl(get_proc)) {
  const std::string& driver = renderer_.driver();
  for (const char* slow : {"llvmpipe", "softpipe", "SWR"})
    if (driver.find(slow) != std::string::npos) slow_ = true;
}

const PosedAnatomy& FigureView::pose(const ViewDocument& document) {
  const int frame = frame_of(subject_, document);
  if (frame == frame_ && subject_.revision == known_) return posed_;
  subject_.pose(frame, posed_, skin_);
  muscle_shortening(*subject_.model, posed_, activity_);
  frame_ = frame;
  known_ = subject_.revision;
  pictured_.reset();
  fine_.drawn.reset();
  coarse_.drawn.reset();
  return posed_;
}

Camera FigureView::camera(const ViewDocument& document, const ViewRoom& room, float width,
                          float height) {
  const Vec3f root = pose(document).X_WJ.front().translation().cast<float>();
  return camera_of(document, root, width, height, room);
}

FigureView::Detail FigureView::detail_for(Wish wish, bool busy) const {
  if (wish == Wish::finest) return Detail::fine;
  if (!slow_) return wish == Wish::still ? Detail::fine : Detail::plain;
  if (wish == Wish::moving) return Detail::half;
  return busy ? Detail::quick : Detail::fine;
}

void FigureView::draw(const ViewDocument& document, const Camera& camera, const Size& size,
                      Wish wish) {
  const PosedAnatomy& posed = pose(document);
  Appearance appearance = appearance_of(document);
  if (tool_.dress) tool_.dress(appearance);
  const bool alike = pictured_ == appearance;
  const Detail detail = detail_for(wish, document.busy);
  const int share = detail == Detail::half ? 2 : 1;
  const int width = std::max(size.width / share, 1), height = std::max(size.height / share, 1);
  const float scale = size.unit / float(share);
  const int first = size.room.alone ? int(scale * size.room.x) : 0;
  const int columns = size.room.alone ? int(std::ceil(scale * size.room.width)) + 1 : 0;
  const bool ready = alike && kept_.width() == width && kept_.height() == height &&
                     detail == detail_ && first == first_column_ && columns == columns_ &&
                     document.touched == touched_ && same_camera(camera) &&
                     document.section == section_ && ground_ == document.ground;
  if (!ready) {
    if (!alike || document.touched != touched_ || document.section != section_) cut_.reset();
    detail_ = detail;
    touched_ = document.touched;
    section_ = document.section;
    first_column_ = first;
    columns_ = columns;
    pictured_ = appearance;
    camera_ = camera;
    ground_ = document.ground;
    const bool quick = detail == Detail::half || detail == Detail::quick;
    const bool coarse = quick && subject_.model->coarse;
    Shown& shown = coarse ? coarse_ : fine_;
    bring_up(coarse ? *subject_.model->coarse : *subject_.model, posed, appearance, shown);
    kept_.resize(width, height);
    rendered_ = true;
    render(posed, appearance, document, shown);
  }
  share_ = 1 / float(share);
  show(size, ready);
}

// A picture that is seen again is put back from the window's own pixels of it.
void FigureView::show(const Size& size, bool again) {
  const int begin = first_column_;
  const int end = columns_ > 0 ? std::min(begin + columns_, kept_.width()) : kept_.width();
  const int to_begin = int(std::lround(float(begin) / share_)),
            to_end = std::min(int(std::lround(float(end) / share_)), size.width);
  const PixelBox seen{to_begin, 0, to_end, size.height};
  gl_.BindFramebuffer(GL_FRAMEBUFFER, 0);
  if (columns_ > 0 && !size.over) {
    gl_.Disable(GL_SCISSOR_TEST);
    gl_.ClearBufferfv(GL_COLOR, 0, kBeside);
  }
  if (store_.width() != size.width || store_.height() != size.height) {
    store_.resize(size.width, size.height);
    stored_ = false;
  }
  if (again && stored_) {
    put_pixels(gl_, seen, store_);
    return;
  }
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, kept_.framebuffer());
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  gl_.BlitFramebuffer(begin, 0, end, kept_.height(), to_begin, 0, to_end, size.height,
                      GL_COLOR_BUFFER_BIT, share_ < 1 ? GL_LINEAR : GL_NEAREST);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, 0);
  stored_ = again;
  if (again) keep_pixels(gl_, seen, store_);
}

void FigureView::took(double seconds) {
  if (std::exchange(rendered_, false) && detail_ == Detail::plain && seconds > kSlow) slow_ = true;
}

std::uint32_t FigureView::part_at(float x, float y) {
  return renderer_.part_at(int(x * share_), int(y * share_));
}

void FigureView::bring_up(const SceneModel& model, const PosedAnatomy& posed,
                          const Appearance& appearance, Shown& shown) {
  if (shown.drawn == appearance) return;
  update_scene(model, posed, skin_.positions.empty() ? nullptr : &skin_, activity_, appearance,
               ++revision_, shown.scene);
  shown.drawn = appearance;
}

template <class Use>
void FigureView::with_tool(const PosedAnatomy& posed, const Appearance& appearance, DrawList& list,
                           const Use& use) {
  const std::size_t meshes = list.meshes.size(), items = list.items.size();
  if (tool_.add) tool_.add(posed, appearance, list);
  use();
  list.meshes.resize(meshes);
  list.items.resize(items);
  list.cut.reset();
}

void FigureView::render(const PosedAnatomy& posed, const Appearance& appearance,
                        const ViewDocument& document, Shown& shown) {
  const bool fine = detail_ == Detail::fine;
  RenderOptions& options = renderer_.options();
  options.supersample = fine ? 2 : 1;
  options.ambient_occlusion = fine;
  options.shadow_size = fine ? 2048 : 1024;
  options.quick = detail_ == Detail::half || detail_ == Detail::quick;
  options.first_column = first_column_;
  options.columns = columns_;
  DrawList& list = shown.scene.list;
  list.ground.visible = document.ground;
  list.camera = camera_;
  with_tool(posed, appearance, list, [&] {
    cut(document, posed, appearance, list);
    renderer_.render_to(list, kept_.width(), kept_.height(), kept_.framebuffer());
  });
}

// Faces are found again where what they cut has changed, not where the eye has: in the fine scene,
// whose meshes are closed. `list`: what is drawn, with what the tool has added.
void FigureView::cut(const ViewDocument& document, const PosedAnatomy& posed,
                     const Appearance& appearance, DrawList& list) {
  if (document.section.kind == SectionPlane::Kind::none || posed.X_WJ.empty()) return;
  const Vec4f plane = plane_of(document.section, subject_.anatomy->skeleton, posed);
  if (cut_ != plane) {
    if (rooms_of_ != subject_.model->number) {
      rooms_ = find_organ_rooms(*subject_.anatomy, subject_.model->surface);
      rooms_of_ = subject_.model->number;
    }
    const std::vector<DrawMesh> rooms = posed_rooms(rooms_, subject_.model->joint_rest, posed);
    DrawList& whole = fine_.scene.list;
    if (&whole == &list) {
      faces_ = cut_faces(plane, whole, rooms);
    } else {
      bring_up(*subject_.model, posed, appearance, fine_);
      with_tool(posed, appearance, whole, [&] { faces_ = cut_faces(plane, whole, rooms); });
    }
  }
  cut_ = plane;
  add_cut(plane, faces_, list);
}

std::vector<FacePlace> FigureView::cut_rooms() const {
  return cut_ ? room_places(faces_) : std::vector<FacePlace>();
}

bool FigureView::same_camera(const Camera& c) const {
  const Camera& was = camera_;
  return c.eye == was.eye && c.target == was.target && c.up == was.up && c.fov_y == was.fov_y &&
         c.ortho_height == was.ortho_height && c.near_plane == was.near_plane &&
         c.far_plane == was.far_plane && c.shift == was.shift;
}

}  // namespace ecorche
