#include "viewer/gl/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/color_space.hpp>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <stdexcept>

#include "anatomy/errors.h"
#include "viewer/gl/gl_api.h"
#include "viewer/gl/gl_context.h"
#include "viewer/gl/gl_program.h"
#include "viewer/gl/gl_targets.h"
#include "viewer/gl/gpu_mesh.h"
#include "viewer/gl/picture_frame.h"
#include "viewer/gl/shaders.h"
#include "viewer/glm_values.h"

namespace ecorche {
namespace {

constexpr int largest_side = 16384;
constexpr double largest_sample_count = 1 << 26;

// Radiance of a light whose colour is given in sRGB.
glm::vec3 radiance(const Vec3f& srgb, float strength) {
  return glm::convertSRGBToLinear(to_glm(srgb)) * strength;
}

// Neither track nor pit.
bool is_plain(const Ground& g) { return g.track_end <= g.track_begin && g.pit_end <= g.pit_begin; }
bool is_opaque(const DrawItem& item) { return item.surface.opacity >= 1; }
bool dissolves(const DrawItem& item) { return item.surface.dissolved > 0; }
PixelWindow within(const PixelWindow& w, const PixelWindow& all) {
  const int x0 = std::max(w.x, all.x), x1 = std::min(w.x + w.width, all.x + all.width);
  return {x0, w.y, std::max(x1 - x0, 0), w.height};
}
bool is_hidden(const DrawItem& item) {
  return (item.surface.opacity <= 0 && item.surface.edge_opacity <= 0) ||
         item.surface.dissolved >= 1;
}

}  // namespace

struct Renderer::Impl {
  Impl(RenderOptions wanted, std::unique_ptr<GlContext> own, GetProc get_proc)
      : options(wanted), context(std::move(own)), gl(load_gl(get_proc)) {
    GLint largest = 0;
    gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    driver_side = std::min(int(largest), largest_side);
    const auto text = [this](GLenum name) {
      const GLubyte* said = gl.GetString(name);
      return said ? reinterpret_cast<const char*>(said) : "unknown";
    };
    driver = fmt::format("{}, {}, OpenGL {}", context ? context->kind() : "window",
                         text(GL_RENDERER), text(GL_VERSION));
    gl.GenVertexArrays(1, &empty_array);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  }
  ~Impl() {
    if (context) context->make_current();
    gl.DeleteVertexArrays(1, &empty_array);
  }

  void draw(const DrawList& list, int width, int height, GLuint framebuffer);
  void set_frame(const GlProgram& program, const DrawList& list) const;
  void draw_shadows(const DrawList& list);
  void draw_background(const DrawList& list);
  void draw_opaque(const DrawList& list);
  void draw_cut_faces(const DrawList& list);
  void draw_occlusion(const DrawList& list);
  void draw_translucent(const DrawList& list);
  void draw_resolved(GLuint framebuffer);
  const GlProgram& surface_program(const DrawList& list, const DrawItem& item) const;
  void set_surface(const GlProgram& program, const DrawItem& item) const;
  void draw_item(const GlProgram& program, const DrawList& list, const DrawItem& item) const;
  int shadow_size() const { return options.quick ? 0 : options.shadow_size; }
  void bind_texture(int unit, GLuint texture) const {
    gl.ActiveTexture(GL_TEXTURE0 + unit);
    gl.BindTexture(GL_TEXTURE_2D, texture);
  }
  void draw_full_screen() const {
    gl.BindVertexArray(empty_array);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
  }
  // The strips below, above and beside it, as far as they are drawn.
  std::array<PixelWindow, 4> around(const PixelWindow& w) const {
    return {within({0, 0, width, w.y}, all),
            within({0, w.y + w.height, width, height - w.y - w.height}, all),
            within({0, w.y, w.x, w.height}, all),
            within({w.x + w.width, w.y, width - w.x - w.width, w.height}, all)};
  }
  void set_scissor(const PixelWindow& w, int scale) const {
    gl.Enable(GL_SCISSOR_TEST);
    gl.Scissor(w.x * scale, w.y * scale, w.width * scale, w.height * scale);
  }

  RenderOptions options;
  std::unique_ptr<GlContext> context;  // outlives what was made in it
  GlApi gl;
  std::string driver;
  int driver_side = 0;
  GLuint empty_array = 0;
  PictureFrame frame;
  int samples = 1;
  int width = 0, height = 0;
  PixelWindow all;  // of the picture, that is drawn
  GpuMeshes meshes{gl};
  GlTarget shadow{gl, {}, true};
  GlTarget ground{gl, {GL_RGBA16F}, true};  // one sample a pixel: it filters itself
  GlTarget scene{gl, {GL_RGBA16F, GL_R32UI, GL_RGBA8}, true};  // colour times opacity, part, normal
  GlTarget raw_open{gl, {GL_R8}, false}, open{gl, {GL_R8}, false};
  GlTarget result{gl, {GL_RGBA8}, false};
  static constexpr const char* dissolve_define = "#define DISSOLVES\n";
  static constexpr const char* fibre_define = "#define HAS_FIBRES\n";
  GlProgram plain_program{gl, "surface", "", shader_prelude, surface_vertex, surface_fragment};
  GlProgram quick_program{
      gl, "quick surface", "#define QUICK\n", shader_prelude, surface_vertex, surface_fragment};
  GlProgram fibre_program{
      gl, "surface with fibres", fibre_define, shader_prelude, surface_vertex, surface_fragment};
  GlProgram dissolve_program{gl,
                             "surface that dissolves",
                             dissolve_define,
                             shader_prelude,
                             surface_vertex,
                             surface_fragment};
  GlProgram shadow_program{gl, "shadow", "", shader_prelude, shadow_vertex, shadow_fragment};
  GlProgram shadow_dissolve_program{
      gl, "shadow that dissolves", dissolve_define, shader_prelude, shadow_vertex, shadow_fragment};
  GlProgram background_program{
      gl, "background", "", shader_prelude, screen_vertex, background_fragment};
  GlProgram background_sunny_program{gl,
                                     "background without shadow",
                                     "#define SUNNY\n",
                                     shader_prelude,
                                     screen_vertex,
                                     background_fragment};
  GlProgram background_empty_program{gl,
                                     "background without ground",
                                     "#define EMPTY\n",
                                     shader_prelude,
                                     screen_vertex,
                                     background_fragment};
  GlProgram background_quick_program{gl,
                                     "quick background",
                                     "#define SUNNY\n#define QUICK\n#define PLAIN\n",
                                     shader_prelude,
                                     screen_vertex,
                                     background_fragment};
  GlProgram occlusion_program{
      gl, "occlusion", "", shader_prelude, screen_vertex, occlusion_fragment};
  GlProgram blur_program{
      gl, "occlusion blur", "", shader_prelude, screen_vertex, occlusion_blur_fragment};
  GlProgram resolve_program{
      gl, "resolve", "#define FIGURE\n", shader_prelude, screen_vertex, resolve_fragment};
  GlProgram resolve_ground_program{
      gl, "resolve ground", "", shader_prelude, screen_vertex, resolve_fragment};
  GlProgram resolve_ground_quick_program{gl,
                                         "quick resolve of the ground",
                                         "#define QUICK\n",
                                         shader_prelude,
                                         screen_vertex,
                                         resolve_fragment};
  GlProgram resolve_quick_program{gl,
                                  "quick resolve",
                                  "#define FIGURE\n#define QUICK\n",
                                  shader_prelude,
                                  screen_vertex,
                                  resolve_fragment};
  std::optional<GlProgram> resolve_transparent_program;  // few pictures need it
};

void Renderer::Impl::set_frame(const GlProgram& program, const DrawList& list) const {
  const Lighting& light = list.lighting;
  program.use();
  program.set("u_view_projection", frame.view_projection);
  program.set("u_unproject", frame.unproject);
  program.set("u_eye", to_glm(list.camera.eye));
  program.set("u_forward", unit(list.camera.target - list.camera.eye));
  program.set("u_parallel", list.camera.ortho_height > 0 ? 1.0f : 0.0f);
  program.set("u_key_direction", frame.key);
  program.set("u_key_color", radiance(light.key_color, light.key_strength));
  program.set("u_sky_color", radiance(light.sky_color, light.ambient_strength));
  program.set("u_floor_color", radiance(light.floor_color, light.ambient_strength));
  program.set("u_rim_direction", frame.rim);
  program.set("u_rim_color", radiance(light.rim_color, light.rim_strength));
  const glm::mat4 to_texture =  // clip -> [0, 1]
      glm::scale(glm::translate(glm::mat4(1), glm::vec3(0.5f)), glm::vec3(0.5f));
  program.set("u_shadow", to_texture * frame.shadow_view_projection);
  program.set("u_shadow_strength", shadow_size() > 0 ? light.shadow_strength : 0.0f);
  program.set("u_shadow_texel", shadow_size() > 0 ? 1.0f / float(shadow_size()) : 0.0f);
  program.set("u_shadow_world", frame.shadow_texel_world);
  program.set("u_shadow_map", 0);
}

const GlProgram& Renderer::Impl::surface_program(const DrawList& list, const DrawItem& item) const {
  if (dissolves(item)) return dissolve_program;
  if (options.quick) return quick_program;
  return item.surface.striation > 0 && !list.meshes[item.mesh].fibres.empty() ? fibre_program
                                                                              : plain_program;
}

void Renderer::Impl::set_surface(const GlProgram& program, const DrawItem& item) const {
  const Surface& s = item.surface;
  program.use();
  program.set("u_normal", glm::inverseTranspose(glm::mat3(to_glm(item.X_WM))));
  program.set("u_opacity", s.opacity);
  program.set("u_edge_opacity", s.edge_opacity);
  program.set("u_roughness", s.roughness);
  program.set("u_specular", s.specular);
  program.set("u_scatter", s.scatter);
  program.set("u_striation", s.striation);
}

void Renderer::Impl::draw_item(const GlProgram& program, const DrawList& list,
                               const DrawItem& item) const {
  program.use();
  if (item.closed) {
    gl.Enable(GL_CULL_FACE);
  } else {
    gl.Disable(GL_CULL_FACE);
  }
  program.set("u_model", to_glm(item.X_WM));
  program.set("u_dissolved", item.surface.dissolved);
  program.set("u_cut", item.cut_face ? glm::vec4(0, 0, 0, 1) : frame.kept);
  meshes.draw(list, item);
}

void Renderer::Impl::draw_shadows(const DrawList& list) {
  if (shadow_size() <= 0 || list.lighting.shadow_strength <= 0) return;
  const int size = std::min(shadow_size(), driver_side);
  const bool fresh = shadow.width() != size;
  shadow.resize(size, size);
  if (fresh) {
    bind_texture(0, shadow.depth());
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  }
  shadow.bind(0);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthMask(GL_TRUE);
  gl.DepthFunc(GL_LESS);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.Enable(GL_POLYGON_OFFSET_FILL);
  gl.PolygonOffset(1.5f, 2.0f);
  for (const GlProgram* program : {&shadow_program, &shadow_dissolve_program}) {
    program->use();
    program->set("u_view_projection", frame.shadow_view_projection);
  }
  for (const DrawItem& item : list.items)
    if (item.casts_shadow && !item.cut_face && item.surface.opacity >= 0.5f && !is_hidden(item))
      draw_item(dissolves(item) ? shadow_dissolve_program : shadow_program, list, item);
  gl.Disable(GL_POLYGON_OFFSET_FILL);
}

// The ground with shadows where one can fall, and without in the four strips around.
void Renderer::Impl::draw_background(const DrawList& list) {
  const Ground& g = list.ground;
  ground.resize(width, height);
  ground.bind();
  bind_texture(0, shadow.depth());
  gl.Disable(GL_CULL_FACE);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_ALWAYS);
  gl.DepthMask(options.quick ? GL_FALSE : GL_TRUE);  // nothing reads it then
  if (options.transparent) {
    gl.DepthMask(GL_TRUE);
    const float nothing[4] = {0, 0, 0, 0}, far_away = 1;
    gl.ClearBufferfv(GL_COLOR, 0, nothing);
    gl.ClearBufferfv(GL_DEPTH, 0, &far_away);
    gl.DepthFunc(GL_LESS);
    return;
  }
  auto draw_in = [&](const GlProgram& p, const PixelWindow& w) {
    if (w.width <= 0 || w.height <= 0) return;
    set_scissor(w, 1);
    set_frame(p, list);
    p.set("u_top", to_glm(list.background_top));
    p.set("u_bottom", to_glm(list.background_bottom));
    p.set("u_ground_height", g.height);
    p.set("u_ground_color", to_glm(g.color));
    p.set("u_grid", g.grid);
    p.set("u_board", g.board);
    p.set("u_fade_distance", 30.0f);
    p.set("u_track", glm::vec4(g.track_center, g.track_half_width, g.track_begin, g.track_end));
    p.set("u_lane", 2 * g.track_half_width / float(std::max(g.lanes, 1)));
    p.set("u_pit", glm::vec3(g.pit_half_width, g.pit_begin, g.pit_end));
    draw_full_screen();
  };
  const PixelWindow w = g.visible && !options.quick ? frame.shadow : PixelWindow{};
  draw_in(background_program, w);
  const GlProgram& rest = !g.visible                     ? background_empty_program
                          : options.quick && is_plain(g) ? background_quick_program
                                                         : background_sunny_program;
  for (const PixelWindow& strip : around(w)) draw_in(rest, strip);
  gl.DepthFunc(GL_LESS);
  gl.Disable(GL_SCISSOR_TEST);
}

void Renderer::Impl::draw_opaque(const DrawList& list) {
  scene.resize(width * samples, height * samples);
  const bool quick = options.quick && samples == 1;
  scene.bind(quick ? 2 : 3);  // nothing reads the normals then
  bind_texture(0, shadow.depth());
  const float nothing[4] = {0, 0, 0, 0}, far_away = 1;
  const GLuint no_part[4] = {0, 0, 0, 0};
  gl.DepthMask(GL_TRUE);
  gl.ClearBufferfv(GL_COLOR, 0, nothing);
  gl.ClearBufferuiv(GL_COLOR, 1, no_part);
  if (!quick) gl.ClearBufferfv(GL_COLOR, 2, nothing);
  gl.ClearBufferfv(GL_DEPTH, 0, &far_away);
  set_scissor(frame.figure, samples);
  for (const GlProgram* program :
       {&plain_program, &quick_program, &fibre_program, &dissolve_program})
    set_frame(*program, list);
  const auto draw_those = [&](const auto& wanted) {
    for (const DrawItem& item : list.items) {
      if (!is_opaque(item) || is_hidden(item) || item.cut_face || !wanted(item)) continue;
      const GlProgram& program = surface_program(list, item);
      set_surface(program, item);
      draw_item(program, list, item);
    }
  };
  // What lies outside first: what it covers is not coloured.
  draw_those([](const DrawItem& item) { return item.surface.striation > 0; });
  draw_those([](const DrawItem& item) { return item.surface.striation <= 0; });
  draw_cut_faces(list);
}

// All that is not in the face's plane lies behind it: the order of triangles decides within it, and
// depth is written after all of them.
void Renderer::Impl::draw_cut_faces(const DrawList& list) {
  for (const DrawItem& item : list.items) {
    if (!item.cut_face || is_hidden(item)) continue;
    const GlProgram& program = options.quick ? quick_program : plain_program;
    set_surface(program, item);
    gl.Enable(GL_POLYGON_OFFSET_FILL);
    gl.PolygonOffset(-1, -4);
    gl.DepthMask(GL_FALSE);
    draw_item(program, list, item);
    gl.DepthMask(GL_TRUE);
    gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw_item(program, list, item);
    gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl.Disable(GL_POLYGON_OFFSET_FILL);
  }
}

// Ambient occlusion at one sample a pixel, of opaque surfaces; translucent ones are drawn later.
void Renderer::Impl::draw_occlusion(const DrawList& list) {
  if (options.quick && samples == 1) return;  // nothing reads it
  raw_open.resize(width, height);
  open.resize(width, height);
  gl.Disable(GL_CULL_FACE);
  gl.Disable(GL_DEPTH_TEST);
  gl.Disable(GL_SCISSOR_TEST);
  const float bright[4] = {1, 1, 1, 1};
  open.bind();
  gl.ClearBufferfv(GL_COLOR, 0, bright);
  if (options.ambient_occlusion && !options.quick && frame.shaded.width > 0) {
    bind_texture(1, scene.depth());
    bind_texture(2, scene.texture(2));
    bind_texture(3, ground.depth());
    raw_open.bind();
    gl.Disable(GL_SCISSOR_TEST);
    gl.ClearBufferfv(GL_COLOR, 0, bright);
    set_scissor(frame.shaded, 1);
    set_frame(occlusion_program, list);
    occlusion_program.set("u_depth", 1);
    occlusion_program.set("u_normals", 2);
    occlusion_program.set("u_ground_depth", 3);
    occlusion_program.set("u_samples", samples);
    occlusion_program.set("u_pixel", 1.0f / glm::vec2(width, height));
    occlusion_program.set("u_radius", frame.occlusion_reach);
    occlusion_program.set("u_ball", glm::vec4(frame.ball.center, frame.ball.radius));
    draw_full_screen();
    open.bind();
    bind_texture(2, raw_open.texture(0));
    blur_program.use();
    blur_program.set("u_depth", 1);
    blur_program.set("u_open", 2);
    blur_program.set("u_ground_depth", 3);
    blur_program.set("u_samples", samples);
    draw_full_screen();
  }
  gl.Enable(GL_DEPTH_TEST);
}

// Draws the depth of the nearest layer, then blends that layer alone: no sorting, no inner walls.
void Renderer::Impl::draw_translucent(const DrawList& list) {
  scene.bind(1);
  set_scissor(frame.figure, samples);
  bind_texture(0, shadow.depth());
  for (const DrawItem& item : list.items) {
    if (is_opaque(item) || is_hidden(item)) continue;
    const GlProgram& program = surface_program(list, item);
    set_surface(program, item);
    gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw_item(dissolves(item) || options.quick ? program : plain_program, list, item);
    gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl.DepthFunc(GL_EQUAL);
    gl.Enable(GL_BLEND);
    gl.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    draw_item(program, list, item);
    gl.Disable(GL_BLEND);
    gl.DepthFunc(GL_LESS);
  }
}

void Renderer::Impl::draw_resolved(GLuint framebuffer) {
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  gl.Viewport(0, 0, width, height);
  gl.Disable(GL_CULL_FACE);
  gl.Disable(GL_DEPTH_TEST);
  gl.Disable(GL_SCISSOR_TEST);
  bind_texture(1, scene.texture(0));
  bind_texture(2, scene.texture(1));
  const bool quick = options.quick && samples == 1;
  if (!quick) bind_texture(3, open.texture(0));
  bind_texture(4, ground.texture(0));
  if (options.transparent && !resolve_transparent_program)
    resolve_transparent_program.emplace(gl, "resolve without background",
                                        "#define FIGURE\n#define TRANSPARENT\n", shader_prelude,
                                        screen_vertex, resolve_fragment);
  const GlProgram* over = options.transparent ? &*resolve_transparent_program
                          : quick             ? &resolve_quick_program
                                              : &resolve_program;
  const GlProgram* under = options.transparent ? over
                           : quick             ? &resolve_ground_quick_program
                                               : &resolve_ground_program;
  const auto draw_in = [&](const GlProgram& program, const PixelWindow& w) {
    if (w.width <= 0 || w.height <= 0) return;
    set_scissor(w, 1);
    program.use();
    program.set("u_color", 1);
    program.set("u_parts", 2);
    program.set("u_open", 3);
    program.set("u_ground", 4);
    program.set("u_samples", samples);
    program.set("u_outline", options.outline);
    draw_full_screen();
  };
  for (const PixelWindow& strip : around(frame.figure)) draw_in(*under, strip);
  draw_in(*over, frame.figure);
  gl.Disable(GL_SCISSOR_TEST);
}

void Renderer::Impl::draw(const DrawList& list, int out_width, int out_height, GLuint framebuffer) {
  if (out_width < 1 || out_height < 1)
    throw UsageError(
        fmt::format("picture size {}x{}: must be at least 1x1", out_width, out_height));
  if (std::max(out_width, out_height) > driver_side)
    throw LimitError(fmt::format("picture size {}x{}: the graphics driver draws at most {} a side",
                                 out_width, out_height, driver_side));
  for (const DrawItem& item : list.items)
    if (item.mesh < 0 || item.mesh >= int(list.meshes.size()))
      throw std::invalid_argument(fmt::format("draw list: item of part {}: mesh {} of {}",
                                              item.part, item.mesh, list.meshes.size()));
  width = out_width;
  height = out_height;
  samples = std::clamp(options.supersample, 1, 4);
  while (samples > 1 && (std::max(width, height) * samples > driver_side ||
                         double(width) * height * samples * samples > largest_sample_count))
    --samples;
  gl.Disable(GL_BLEND);
  gl.Disable(GL_CULL_FACE);
  gl.Disable(GL_SCISSOR_TEST);
  meshes.begin(list);
  frame = make_picture_frame(list, meshes, width, height, shadow_size());
  all = {0, 0, width, height};
  if (options.columns > 0) all = within({options.first_column, 0, options.columns, height}, all);
  for (PixelWindow* w : {&frame.figure, &frame.shadow, &frame.shaded}) *w = within(*w, all);
  if (list.cut) gl.Enable(GL_CLIP_DISTANCE0);
  draw_shadows(list);
  gl.Disable(GL_CLIP_DISTANCE0);
  draw_background(list);
  if (list.cut) gl.Enable(GL_CLIP_DISTANCE0);
  draw_opaque(list);
  gl.Disable(GL_CLIP_DISTANCE0);
  draw_occlusion(list);
  if (list.cut) gl.Enable(GL_CLIP_DISTANCE0);
  draw_translucent(list);
  gl.Disable(GL_CLIP_DISTANCE0);
  draw_resolved(framebuffer);
}

Renderer::Renderer(RenderOptions options) {
  std::unique_ptr<GlContext> context = make_headless_context();
  const GetProc get_proc = context->get_proc();
  impl_ = std::make_unique<Impl>(options, std::move(context), get_proc);
}

Renderer::Renderer(RenderOptions options, GetProc get_proc)
    : impl_(std::make_unique<Impl>(options, nullptr, get_proc)) {}

Renderer::~Renderer() = default;

RenderOptions& Renderer::options() { return impl_->options; }
const std::string& Renderer::driver() const { return impl_->driver; }

Image Renderer::render(const DrawList& list, int width, int height) {
  Impl& r = *impl_;
  if (r.context) r.context->make_current();
  if (width >= 1 && height >= 1 && std::max(width, height) <= r.driver_side)
    r.result.resize(width, height);
  r.draw(list, width, height, r.result.framebuffer());
  Image upside_down = make_image(width, height), image = make_image(width, height);
  image.transparent = r.options.transparent;
  r.gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
  r.gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, upside_down.rgba.data());
  for (int y = 0; y < height; ++y)
    std::copy_n(upside_down.pixel(0, height - 1 - y), 4 * width, image.pixel(0, y));
  return image;
}

void Renderer::render_to(const DrawList& list, int width, int height, unsigned framebuffer) {
  impl_->draw(list, width, height, framebuffer);
}

std::uint32_t Renderer::part_at(int x, int y) {
  Impl& r = *impl_;
  if (x < 0 || y < 0 || x >= r.width || y >= r.height) return 0;
  if (r.context) r.context->make_current();
  std::uint32_t part = 0;
  GLint drawn_into = 0;
  r.gl.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &drawn_into);
  r.gl.BindFramebuffer(GL_FRAMEBUFFER, r.scene.framebuffer());
  r.gl.ReadBuffer(GL_COLOR_ATTACHMENT1);
  r.gl.ReadPixels(x * r.samples, (r.height - 1 - y) * r.samples, 1, 1, GL_RED_INTEGER,
                  GL_UNSIGNED_INT, &part);
  r.gl.BindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(drawn_into));
  return part;
}

std::vector<std::uint32_t> Renderer::parts() {
  Impl& r = *impl_;
  if (r.context) r.context->make_current();
  const int w = r.width * r.samples, h = r.height * r.samples;
  std::vector<std::uint32_t> all(std::size_t(w) * h), out(std::size_t(r.width) * r.height);
  r.gl.BindFramebuffer(GL_FRAMEBUFFER, r.scene.framebuffer());
  r.gl.ReadBuffer(GL_COLOR_ATTACHMENT1);
  r.gl.ReadPixels(0, 0, w, h, GL_RED_INTEGER, GL_UNSIGNED_INT, all.data());
  for (int y = 0; y < r.height; ++y)
    for (int x = 0; x < r.width; ++x)
      out[y * r.width + x] = all[((r.height - 1 - y) * r.samples) * w + x * r.samples];
  return out;
}

}  // namespace ecorche
