#include "viewer/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "anatomy/muscles/action_line.h"
#include "viewer/scene_order.h"

namespace ecorche {
namespace {

// Light and dark tell shortened from stretched where hues cannot.
const Vec3f short_color(0.95f, 0.52f, 0.20f);
const Vec3f long_color(0.36f, 0.19f, 0.42f);
const Vec3f selected_color(0.98f, 0.80f, 0.25f);
const Vec3f marked_color(0.20f, 0.62f, 0.60f);
// Okabe & Ito's orange, which flesh and light turn yellow, and their blue, with a light grey
// between them.
const Vec3f map_short(0.90f, 0.62f, 0.00f);
const Vec3f map_rest(0.88f, 0.87f, 0.85f);
const Vec3f map_long(0.00f, 0.45f, 0.70f);
const Vec3f effort_none(0.95f, 0.91f, 0.76f);
const Vec3f effort_half(0.96f, 0.50f, 0.16f);
const Vec3f effort_full(0.46f, 0.02f, 0.12f);

// Smooth noise in space: patches in which the skin dissolves.
float patchiness(const Vec3f& p) {
  const Eigen::Vector3i cell = p.array().floor().cast<int>();
  const Vec3f f = p - cell.cast<float>();
  const Vec3f t = f.array() * f.array() * (3 - 2 * f.array());
  float sum = 0;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3i c = cell + Eigen::Vector3i(k & 1, (k >> 1) & 1, k >> 2);
    const std::uint32_t seed = c.x() * 73856093 ^ c.y() * 19349663 ^ c.z() * 83492791;
    sum += scattered(seed) * (k & 1 ? t.x() : 1 - t.x()) * (k & 2 ? t.y() : 1 - t.y()) *
           (k & 4 ? t.z() : 1 - t.z());
  }
  return sum;
}

std::vector<Vec3f> to_float(const Points& points) {
  std::vector<Vec3f> out(points.rows());
  for (Eigen::Index i = 0; i < points.rows(); ++i) out[i] = points.row(i).transpose().cast<float>();
  return out;
}

std::vector<Triangle32> to_indices(const Triangles& triangles) {
  std::vector<Triangle32> out(triangles.rows());
  for (Eigen::Index i = 0; i < triangles.rows(); ++i)
    out[i] = triangles.row(i).transpose().cast<std::uint32_t>();
  return out;
}

void set_normals(DrawMesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), Vec3f::Zero());
  for (const Triangle32& t : mesh.triangles) {
    const Vec3f n = (mesh.positions[t[1]] - mesh.positions[t[0]])
                        .cross(mesh.positions[t[2]] - mesh.positions[t[0]]);
    for (int k = 0; k < 3; ++k) mesh.normals[t[k]] += n;
  }
  for (Vec3f& n : mesh.normals) n = n.squaredNorm() > 0 ? n.normalized() : Vec3f(0, 1, 0);
}

DrawMesh make_mesh(const TriMesh& source, std::uint64_t key) {
  DrawMesh mesh;
  mesh.key = key;
  mesh.positions = to_float(source.V);
  mesh.triangles = to_indices(source.F);
  set_normals(mesh);
  return mesh;
}

// Sets the order in which vertices dissolve: from the feet upwards, in patches.
void set_dissolve_order(DrawMesh& skin) {
  if (skin.positions.empty()) return;
  float low = skin.positions[0].y(), high = low;
  for (const Vec3f& p : skin.positions) low = std::min(low, p.y()), high = std::max(high, p.y());
  const float height = std::max(high - low, 1e-6f);
  skin.dissolve.clear();
  for (const Vec3f& p : skin.positions) {
    const Vec3f q = p / height;
    const float patches =
        0.6f * patchiness(17 * q) + 0.3f * patchiness(41 * q) + 0.1f * patchiness(97 * q);
    skin.dissolve.push_back(
        std::clamp(0.72f * (p.y() - low) / height + 0.28f * patches, 0.001f, 0.999f));
  }
}

// Fibres lie side by side around each strip, `fascicle` wide at its thickest.
void set_fibres(DrawMesh& muscles, const MuscleSurface& surface, const Anatomy& anatomy,
                std::span<const SliceRange> strips, double fascicle) {
  std::vector<float> fibres, lengths;
  for (const SliceRange& range : strips) {
    const Strip& strip = anatomy.muscles[range.muscle].strips[range.strip];
    double girth = 0;
    for (const Slice& slice : strip.slices)
      girth = std::max(girth, std::numbers::pi * (slice.radii.x() + slice.radii.y()));
    fibres.insert(fibres.end(), strip.slices.size(),
                  std::max(6.0f, float(std::round(girth / fascicle))));
    lengths.insert(lengths.end(), strip.slices.size(), float(strip.rest_length));
  }
  for (int i = 0; i < surface.vertices(); ++i) {
    const int k = surface.slice[i];
    muscles.fibres.emplace_back(std::cos(surface.angle[i]), std::sin(surface.angle[i]), fibres[k],
                                surface.along[i] * lengths[k]);
  }
}

// Fibres lie side by side across each sheet.
void set_fibres(DrawMesh& fascia, const FasciaSurface& surface, double fascicle) {
  for (const FasciaSurface::Part& part : surface.parts) {
    const float width = surface.across[part.vertex_end - 1];
    const float fibres = std::max(6.0f, float(std::round(2 * width / fascicle)));
    for (int i = part.vertex_begin; i < part.vertex_end; ++i) {
      const float angle = std::numbers::pi_v<float> * surface.across[i] / std::max(width, 1e-6f);
      fascia.fibres.emplace_back(std::cos(angle), std::sin(angle), fibres, surface.along[i]);
    }
  }
}

Vec3f mix(const Vec3f& a, const Vec3f& b, float t) { return a + t * (b - a); }

Vec3f tendon_color(MuscleColors colors) {
  return colors != MuscleColors::flesh ? Vec3f(0.70f, 0.69f, 0.67f) : kTendonLook.color;
}

void color_muscles(const SceneModel& model, std::span<const float> activity,
                   const Appearance& appearance, DrawMesh& mesh) {
  mesh.colors.resize(model.surface.vertices());
  for (const MuscleSurface::Part& part : model.surface.parts) {
    const float a = activity.empty() ? 0 : std::clamp(activity[part.muscle], -1.0f, 1.0f);
    const auto [belly, tendon] = muscle_tones(appearance, part.muscle, a);
    for (int i = part.vertex_begin; i < part.vertex_end; ++i)
      mesh.colors[i] = mix(tendon, belly, model.surface.belly[i]);
  }
}

void color_fascia(const SceneModel& model, const Appearance& appearance, DrawMesh& mesh) {
  mesh.colors.resize(mesh.parts.size());
  const Vec3f belly = muscle_color(appearance.muscle_colors, 0),
              sheet = tendon_color(appearance.muscle_colors);
  for (std::size_t i = 0; i < mesh.colors.size(); ++i) {
    mesh.colors[i] = mix(mesh.parts[i] == appearance.selected ? selected_color : sheet, belly,
                         model.fascia_surface.belly[i]);
  }
}

void copy_into(const PointsF& from, std::vector<Vec3f>& to) {
  to.resize(from.rows());
  std::copy_n(from.data(), from.size(), to.empty() ? nullptr : to.front().data());
}

void take_skin(const SkinFrame& frame, std::span<const std::uint32_t> from, DrawMesh& mesh) {
  const bool fits = from.empty() ? frame.positions.size() == 4 * mesh.positions.size()
                                 : frame.positions.size() > 4 * std::size_t(from.back());
  if (!fits || frame.normals.size() != frame.positions.size())
    throw std::invalid_argument(fmt::format("update_scene: {} skin coordinates for {} vertices",
                                            frame.positions.size(), mesh.positions.size()));
  const auto at = [](const auto& values, std::size_t k) {
    return Vec3f(values[4 * k], values[4 * k + 1], values[4 * k + 2]);
  };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const std::size_t k = from.empty() ? i : from[i];
    mesh.positions[i] = at(frame.positions, k);
    mesh.normals[i] = at(frame.normals, k);
  }
}

Surface bone_surface(const Appearance& appearance, float opacity) {
  return {.color = appearance.bone_color,
          .opacity = opacity,
          .roughness = kBoneLook.roughness,
          .specular = 0.035f,
          .scatter = 0.25f};
}

Surface muscle_surface(float opacity) {
  return {.color = kMuscleLook.color,
          .opacity = opacity,
          .roughness = kMuscleLook.roughness,
          .specular = 0.045f,
          .scatter = 0.35f,
          .striation = 1};
}

Surface fascia_surface(float opacity) {
  Surface surface = muscle_surface(opacity);
  surface.color = kTendonLook.color;
  return surface;
}

Surface skin_surface(const Appearance& appearance, const Look& look) {
  return {.color = appearance.skin_color,
          .opacity = look.skin,
          .edge_opacity = look.skin_edge,
          .dissolved = look.skin_dissolved,
          .roughness = kSkinLook.roughness,
          .specular = 0.035f,
          .scatter = 0.6f};
}

Mat4f translation_by(const Vec3f& offset) {
  Mat4f m = Mat4f::Identity();
  m.topRightCorner<3, 1>() = offset;
  return m;
}

// Copies the model's meshes into the list in the order skin, muscles, fascia, bones, eyes, unless
// they are already there.
void take_meshes(const SceneModel& model, Scene& scene) {
  std::vector<DrawMesh>& own = scene.list.meshes;
  std::vector<const DrawMesh*> wanted{&model.skin, &model.muscles, &model.fascia};
  for (const DrawMesh& bone : model.bones) wanted.push_back(&bone);
  for (const DrawMesh& eye : model.eyes) wanted.push_back(&eye);
  const auto is_there = [&](std::size_t k) {
    const bool moves = k < std::size_t(kFirstBoneMesh) ||
                       (k == std::size_t(kFirstBoneMesh) && !model.together_joints.empty());
    return own[k].key == wanted[k]->key && (moves || own[k].revision == wanted[k]->revision) &&
           (k != std::size_t(kSkinMesh) ||
            own[k].positions.size() == wanted[k]->positions.size()) &&
           own[k].fibres.size() == wanted[k]->fibres.size();
  };
  own.resize(wanted.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    if (is_there(k) && wanted[k]->key != 0) continue;
    own[k] = *wanted[k];
    if (k == std::size_t(kMuscleMesh) || k == std::size_t(kFasciaMesh) ||
        k == std::size_t(kFirstBoneMesh))
      scene.parts_left_away.assign(1, kSkinPart);  // no such part: taken anew
  }
}

bool is_hidden(const Appearance& appearance, std::uint32_t part) {
  return std::binary_search(appearance.hidden.begin(), appearance.hidden.end(), part);
}

// Hash of the hidden parts; independent of scene and run.
std::uint64_t faces_without(std::span<const std::uint32_t> parts) {
  std::uint64_t hash = 0xcbf29ce484222325u;  // Fowler, Noll and Vo's, 1a
  for (const std::uint32_t part : parts) hash = (hash ^ part) * 0x100000001b3u;
  return parts.empty() ? 0 : hash;
}

// The triangles of parts that are not hidden.
void take_shown(const DrawMesh& all, const std::vector<PartFaces>& parts,
                const Appearance& appearance, std::uint64_t faces, DrawMesh& mesh) {
  mesh.triangles.clear();
  for (const PartFaces& part : parts)
    if (!is_hidden(appearance, part.part))
      mesh.triangles.insert(mesh.triangles.end(), all.triangles.begin() + long(part.begin),
                            all.triangles.begin() + long(part.end));
  mesh.faces = faces;
}

// Removes the triangles of hidden parts of shared meshes, which are then neither seen nor picked
// and cast no shadows.
void remove_hidden(const SceneModel& model, const Appearance& appearance, Scene& scene) {
  const bool together = !model.together_joints.empty();
  const auto first = std::lower_bound(appearance.hidden.begin(), appearance.hidden.end(),
                                      together ? kFirstBonePart : kFirstMusclePart);
  const std::span<const std::uint32_t> hidden(first, appearance.hidden.end());
  if (std::ranges::equal(hidden, scene.parts_left_away)) return;
  const std::uint64_t faces = faces_without(hidden);
  std::vector<DrawMesh>& own = scene.list.meshes;
  take_shown(model.muscles, model.muscle_faces, appearance, faces, own[kMuscleMesh]);
  take_shown(model.fascia, model.fascia_faces, appearance, faces, own[kFasciaMesh]);
  if (together)
    take_shown(model.bones[0], model.bone_faces, appearance, faces, own[kFirstBoneMesh]);
  scene.parts_left_away.assign(hidden.begin(), hidden.end());
}

Mat4f joint_motion(const SceneModel& model, const PosedAnatomy& posed, int joint) {
  Transform rest_to_joint = Transform::Identity();
  rest_to_joint.translation() = -model.joint_rest[joint];
  const Transform moved = posed.X_WJ[joint] * rest_to_joint;
  return moved.matrix().cast<float>();
}

void add_look(const SceneModel& model, const PosedAnatomy& posed, const Appearance& appearance,
              const Look& look, DrawList& list) {
  const Mat4f offset = translation_by(look.offset);
  const bool together = !model.together_joints.empty();
  if (look.bones > 0 && together && !list.meshes[kFirstBoneMesh].triangles.empty()) {
    DrawItem& item = list.items.emplace_back();
    item.mesh = kFirstBoneMesh;
    item.X_WM = offset;
    item.surface = bone_surface(appearance, look.bones);
    item.closed = true;
  }
  if (look.bones > 0 && !together) {
    for (std::size_t b = 0; b < model.bones.size(); ++b) {
      const std::uint32_t part = kFirstBonePart + std::uint32_t(b);
      if (is_hidden(appearance, part)) continue;
      DrawItem& item = list.items.emplace_back();
      item.mesh = int(kFirstBoneMesh + b);
      item.X_WM = offset * joint_motion(model, posed, model.bone_joints[b]);
      item.surface = bone_surface(appearance, look.bones);
      item.closed = true;
      item.part = part;
      if (item.part == appearance.selected) item.surface.color = selected_color;
      item.casts_shadow =
          look.muscles < 0.5f || model.bone_shadows[b] || !appearance.hidden.empty();
    }
  }
  // Eyes are drawn with opaque muscles or opaque skin, but not with bare bones.
  const bool faced = look.muscles >= 1 || (look.skin >= 1 && look.skin_dissolved < 1);
  if (faced && !is_hidden(appearance, kEyesPart)) {
    for (std::size_t e = 0; e < model.eyes.size(); ++e) {
      DrawItem& item = list.items.emplace_back();
      item.mesh = int(kFirstBoneMesh + model.bones.size() + e);
      item.X_WM = offset * joint_motion(model, posed, model.eye_joints[e]);
      item.surface = {.color = Vec3f(0.9f, 0.9f, 0.9f),
                      .roughness = kEyeWhiteLook.roughness,
                      .specular = 0.04f,
                      .scatter = 0.2f};
      item.casts_shadow = false;
      item.closed = true;
    }
  }
  if (look.muscles > 0 && !list.meshes[kMuscleMesh].triangles.empty()) {
    DrawItem& item = list.items.emplace_back();
    item.mesh = kMuscleMesh;
    item.X_WM = offset;
    item.surface = muscle_surface(look.muscles);
    item.closed = true;
  }
  if (look.muscles > 0 && !list.meshes[kFasciaMesh].triangles.empty()) {
    DrawItem& item = list.items.emplace_back();
    item.mesh = kFasciaMesh;
    item.X_WM = offset;
    item.surface = fascia_surface(look.muscles);
  }
  const bool skinned = (look.skin > 0 || look.skin_edge > 0) && look.skin_dissolved < 1 &&
                       !model.skin.triangles.empty();
  if (skinned && !is_hidden(appearance, kSkinPart)) {
    DrawItem& item = list.items.emplace_back();
    item.mesh = kSkinMesh;
    item.X_WM = offset;
    item.surface = skin_surface(appearance, look);
    item.closed = !model.skin_from.empty();  // what quick pictures show of its inside is no loss
    item.part = kSkinPart;
  }
}

// Ball around the visible parts of this frame.
void set_focus(const PosedAnatomy& posed, const Appearance& appearance, DrawList& list) {
  Vec3f low = Vec3f::Constant(1e30f), high = -low;
  for (const Transform& joint : posed.X_WJ)
    for (const Look& look : appearance.looks) {
      const Vec3f p = joint.translation().cast<float>() + look.offset;
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  if (!(low.x() <= high.x())) return;
  // Flesh, and the top of the head, reach beyond the joints.
  list.focus = 0.5f * (low + high);
  list.focus_radius = 0.5f * (high - low).norm() + 0.25f;
}

DrawMesh make_eye(const Eyeball& eye, std::uint64_t key) {
  DrawMesh mesh;
  mesh.key = key;
  for (const EyePart& part : eye_parts(eye)) {
    const std::uint32_t first = mesh.positions.size();
    for (Eigen::Index i = 0; i < part.mesh.V.rows(); ++i) {
      mesh.positions.push_back(part.mesh.V.row(i).transpose().cast<float>());
      mesh.normals.push_back(part.normals.row(i).transpose().cast<float>());
      mesh.colors.push_back(part.look.color);
    }
    for (const Triangle32& t : to_indices(part.mesh.F))
      mesh.triangles.emplace_back(t.array() + first);
  }
  return mesh;
}

// All bones in the pose, in one mesh.
void pose_bones(const SceneModel& model, const PosedAnatomy& posed, const Appearance& appearance,
                DrawMesh& mesh) {
  const DrawMesh& rest = model.bones[0];
  Mat4f X = Mat4f::Identity();
  int of = -1;
  mesh.colors.resize(rest.positions.size());
  for (std::size_t i = 0; i < rest.positions.size(); ++i) {
    if (const int joint = model.together_joints[i]; joint != of)
      X = joint_motion(model, posed, of = joint);
    const Eigen::Matrix3f turn = X.topLeftCorner<3, 3>();
    mesh.positions[i] = turn * rest.positions[i] + X.topRightCorner<3, 1>();
    mesh.normals[i] = turn * rest.normals[i];
    mesh.colors[i] = rest.parts[i] == appearance.selected ? selected_color : appearance.bone_color;
  }
}

}  // namespace

Vec3f muscle_color(MuscleColors colors, float activity) {
  if (colors == MuscleColors::activation) {
    const float twice = 2 * std::clamp(activity, 0.0f, 1.0f);
    return twice < 1 ? mix(effort_none, effort_half, twice)
                     : mix(effort_half, effort_full, twice - 1);
  }
  const bool map = colors == MuscleColors::shortening;
  const Vec3f &rest = map ? map_rest : kMuscleLook.color,
              &end =
                  activity >= 0 ? (map ? map_short : short_color) : (map ? map_long : long_color);
  return mix(rest, end, std::min(std::abs(activity), 1.0f));
}

MuscleTones muscle_tones(const Appearance& appearance, int muscle, float activity) {
  const std::uint32_t part = kFirstMusclePart + std::uint32_t(muscle);
  MuscleTones out{muscle_color(appearance.muscle_colors, activity),
                  tendon_color(appearance.muscle_colors)};
  if (appearance.muscle_colors == MuscleColors::flesh) out.belly *= muscle_tone(muscle);
  if (std::ranges::binary_search(appearance.marked, part))
    out = {marked_color, mix(out.tendon, marked_color, 0.5f)};
  if (appearance.selected == part) out = {selected_color, mix(out.tendon, selected_color, 0.5f)};
  return out;
}

Part part_of(std::uint32_t number) {
  if (number >= kFirstRoomPart) return {Part::Kind::room, int(number - kFirstRoomPart)};
  if (number >= kFirstFasciaPart) return {Part::Kind::fascia, int(number - kFirstFasciaPart)};
  if (number >= kFirstMusclePart) return {Part::Kind::muscle, int(number - kFirstMusclePart)};
  if (number >= kFirstBonePart) return {Part::Kind::bone, int(number - kFirstBonePart)};
  if (number == kSkinPart) return {Part::Kind::skin, 0};
  if (number == kEyesPart) return {Part::Kind::eyes, 0};
  return {};
}

std::uint64_t fresh_scene_key() {
  static std::atomic<std::uint64_t> last{1};
  return ++last;
}

void set_fascia(FasciaSurface surface, SceneModel& model) {
  model.fascia.triangles = to_indices(surface.F);
  for (const FasciaSurface::Part& part : surface.parts) {
    const std::uint32_t number = kFirstFasciaPart + std::uint32_t(part.sheet);
    model.fascia.parts.resize(part.vertex_end, number);
    model.fascia_faces.push_back(
        {number, std::size_t(part.face_begin), std::size_t(part.face_end)});
  }
  model.fascia_surface = std::move(surface);
}

SceneModel make_scene_model(const Anatomy& anatomy, const TriMesh& skin,
                            const SceneOptions& options) {
  SceneModel model;
  model.number = fresh_scene_key();
  const std::uint64_t key = options.key << 32;
  model.skin = make_mesh(skin, key + 1);
  set_dissolve_order(model.skin);
  for (std::size_t b = 0; b < anatomy.bones.size(); ++b) {
    model.bones.push_back(make_mesh(anatomy.bones[b].mesh, key + 4 + b));
    model.bone_joints.push_back(anatomy.bones[b].joint);
    const std::string& joint = anatomy.skeleton.joints[anatomy.bones[b].joint].name;
    model.bone_shadows.push_back(joint == "head" || joint == "jaw");
  }
  for (const Eyeball& eye : options.eyes) {
    model.eyes.push_back(make_eye(eye, key + 4 + anatomy.bones.size() + model.eyes.size()));
    model.eye_joints.push_back(eye.joint);
  }
  model.joint_rest = rest_positions(anatomy.skeleton);
  model.strips = slice_ranges(anatomy);
  for (const SliceRange& range : model.strips)
    model.rest_lengths.push_back(anatomy.muscles[range.muscle].strips[range.strip].rest_length);
  model.muscle_count = anatomy.muscles.size();
  model.muscles.key = key + 2;
  model.fascia.key = key + 3;
  set_fascia(make_fascia_again(anatomy, options.before), model);
  set_fibres(model.fascia, model.fascia_surface, options.fascicle);
  if (anatomy.muscles.empty()) {
    return model;
  }
  model.surface = make_muscle_surface(anatomy, options.surface);
  model.muscles.triangles = to_indices(model.surface.F);
  for (const int m : model.surface.muscle)
    model.muscles.parts.push_back(kFirstMusclePart + std::uint32_t(m));
  set_fibres(model.muscles, model.surface, anatomy, model.strips, options.fascicle);
  for (const MuscleSurface::Part& part : model.surface.parts)
    model.muscle_faces.push_back({kFirstMusclePart + std::uint32_t(part.muscle),
                                  std::size_t(part.face_begin), std::size_t(part.face_end)});
  return model;
}

void muscle_shortening(const SceneModel& model, const PosedAnatomy& posed,
                       std::vector<float>& out) {
  if (posed.lengths.size() != model.rest_lengths.size())
    throw std::invalid_argument(fmt::format("muscle_shortening: {} lengths for {} strips",
                                            posed.lengths.size(), model.rest_lengths.size()));
  out.assign(model.muscle_count, 0);
  for (std::size_t k = 0; k < model.strips.size();) {
    const int m = model.strips[k].muscle;
    double rest = 0, now = 0;
    for (; k < model.strips.size() && model.strips[k].muscle == m; ++k)
      rest += model.rest_lengths[k], now += posed.lengths[k];
    if (rest > 0) out[m] = float(std::clamp((rest - now) / (0.2 * rest), -1.0, 1.0));
  }
}

void update_scene(const SceneModel& model, const PosedAnatomy& posed, const SkinFrame* skin,
                  std::span<const float> activity, const Appearance& appearance,
                  std::uint64_t revision, Scene& scene) {
  if (posed.X_WJ.size() != model.joint_rest.size())
    throw std::invalid_argument(fmt::format("update_scene: a pose of {} joints for {}",
                                            posed.X_WJ.size(), model.joint_rest.size()));
  if (!activity.empty() && int(activity.size()) != model.muscle_count)
    throw std::invalid_argument(fmt::format("update_scene: {} activities for {} muscles",
                                            activity.size(), model.muscle_count));
  take_meshes(model, scene);
  remove_hidden(model, appearance, scene);
  DrawMesh& muscles = scene.list.meshes[kMuscleMesh];
  if (model.muscle_count > 0) {
    update_muscle_surface(model.surface, posed, scene.muscle_positions, &scene.muscle_normals);
    copy_into(scene.muscle_positions, muscles.positions);
    copy_into(scene.muscle_normals, muscles.normals);
    color_muscles(model, activity, appearance, muscles);
    muscles.revision = revision;
  }
  if (model.fascia_surface.vertices() > 0) {
    DrawMesh& fascia = scene.list.meshes[kFasciaMesh];
    update_fascia_surface(model.fascia_surface, posed, scene.fascia_positions,
                          &scene.fascia_normals);
    copy_into(scene.fascia_positions, fascia.positions);
    copy_into(scene.fascia_normals, fascia.normals);
    color_fascia(model, appearance, fascia);
    fascia.revision = revision;
  }
  if (skin) {
    take_skin(*skin, model.skin_from, scene.list.meshes[kSkinMesh]);
    scene.list.meshes[kSkinMesh].revision = revision;
  }
  if (!model.together_joints.empty()) {
    pose_bones(model, posed, appearance, scene.list.meshes[kFirstBoneMesh]);
    scene.list.meshes[kFirstBoneMesh].revision = revision;
  }
  scene.list.items.clear();
  scene.list.cut.reset();
  for (const Look& look : appearance.looks) add_look(model, posed, appearance, look, scene.list);
  set_focus(posed, appearance, scene.list);
}

}  // namespace ecorche
