// Draw list: meshes, their transforms, light, ground and camera as plain values, without a graphics
// API.
//
// World metres, +Y up; colours are sRGB in [0, 1] (as on the screen) and are turned into linear
// light by the renderer.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace ecorche {

using Vec3f = Eigen::Vector3f;
using Vec4f = Eigen::Vector4f;
using Mat4f = Eigen::Matrix4f;
using Triangle32 = Eigen::Matrix<std::uint32_t, 3, 1>;

// Geometry. Arrays other than positions, normals and triangles may be empty; those present have #V
// entries.
struct DrawMesh {
  // identifies the mesh from one list to the next, so that it is uploaded once; 0: upload it for
  // every picture
  std::uint64_t key = 0;
  // a new value: positions, normals and colours have changed; the rest is constant for a key
  std::uint64_t revision = 0;
  std::uint64_t shape = 0;  // a new value: triangles and all other arrays have changed, too
  std::uint64_t faces = 0;  // a new value: triangles have changed, nothing else
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;    // unit
  std::vector<Vec3f> colors;     // empty: the item's colour
  std::vector<float> occlusion;  // baked ambient occlusion: 1 open .. 0 closed
  std::vector<float> dissolve;   // order of dissolving in [0, 1], 0 first (see Surface::dissolved)
  std::vector<Vec4f>
      fibres;  // cos and sin of the angle around the belly, fibres around it, metres along it
  std::vector<std::uint32_t> parts;   // for picking and outlines; empty: the item's
  std::vector<Triangle32> triangles;  // counter-clockwise seen from outside
};

// Material of a surface.
struct Surface {
  Vec3f color{0.8f, 0.8f, 0.8f};
  // below 1: the nearest layer is blended over everything behind it, in any drawing order
  float opacity = 1;
  // added to the opacity where the surface is seen at a grazing angle (glass skin)
  float edge_opacity = 0;
  float dissolved = 0;     // share of the surface that has dissolved; needs DrawMesh::dissolve
  float roughness = 0.6f;  // of the highlight, 0 mirror .. 1 matt
  float specular = 0.04f;  // reflectance at right angles
  float scatter = 0;       // subsurface scattering into the shade (skin, flesh), 0 .. 1
  float striation = 0;     // depth of fibre lines; needs DrawMesh::fibres
};

struct DrawItem {
  int mesh = 0;  // index into DrawList::meshes
  Mat4f X_WM = Mat4f::Identity();
  Surface surface;
  std::uint32_t part = 0;  // 0: cannot be picked and has no outline
  bool casts_shadow = true;
  bool closed = false;  // its inside is never seen: triangles that face away are left out
  // The face of a cut: flat, whole where DrawList::cut takes all else away; later triangles lie on
  // earlier ones.
  bool cut_face = false;
};

struct Camera {
  Vec3f eye{0, 1, 4};
  Vec3f target{0, 1, 0};
  Vec3f up{0, 1, 0};
  float fov_y = 0.5f;      // rad
  float ortho_height = 0;  // metres seen from top to bottom; above 0: parallel projection
  float near_plane = 0.05f;
  float far_plane = 200;
  // offset of the target from the picture's centre, to the right and up, in halves of its width and
  // height
  Eigen::Vector2f shift{0, 0};
};

struct Lighting {
  Vec3f key_direction{-0.45f, -0.8f, -0.55f};  // direction in which the light travels, world
  Vec3f key_color{1.0f, 0.95f, 0.88f};
  float key_strength = 1.35f;
  Vec3f sky_color{0.80f, 0.88f, 1.0f};
  Vec3f floor_color{0.72f, 0.60f, 0.52f};  // ambient light from below
  float ambient_strength = 0.42f;
  Vec3f rim_color{0.85f, 0.92f, 1.0f};  // from behind the subject, seen from the camera
  float rim_strength = 0.9f;
  float shadow_strength = 1;
  // directions are then in the camera's frame (studio light for stills)
  bool follows_camera = false;
};

// A studio's light, which comes over the camera's shoulder: no side lies in the dark.
inline void light_from_camera(float ambient_strength, Lighting& lighting) {
  lighting.follows_camera = true;
  lighting.key_direction = Vec3f(0.45f, -0.6f, -0.75f);
  lighting.ambient_strength = ambient_strength;
}

// A runway along +Z that ends in a pit of sand. Track and pit are left out if their interval is
// empty (end <= begin).
struct Ground {
  bool visible = false;
  float height = 0;  // y of the plane
  Vec3f color{0.80f, 0.80f, 0.78f};
  float grid = 1;  // metres between lines; 0: none
  float track_half_width = 0.61f;
  int lanes = 1;                         // side by side within it, with lines between
  float track_center = 0;                // x
  float track_begin = 0, track_end = 0;  // z
  float board = 0;  // z of the take-off line; the board is 0.20 m deep and ends there; 0: none
  float pit_half_width = 1.4f;
  float pit_begin = 0, pit_end = 0;  // z
};

struct DrawList {
  std::vector<DrawMesh> meshes;
  std::vector<DrawItem> items;
  Camera camera;
  Lighting lighting;
  Ground ground;
  Vec3f background_top{0.86f, 0.88f, 0.91f};
  Vec3f background_bottom{0.97f, 0.97f, 0.96f};
  // Ball that has shadows and ambient occlusion; radius 0: the ball around all items that cast
  // shadows.
  Vec3f focus{0, 0, 0};
  float focus_radius = 0;
  // A plane, n . x = w for (n, w): what lies on the eye's side of it is not drawn.
  std::optional<Vec4f> cut{};
};

}  // namespace ecorche
