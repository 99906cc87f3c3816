#include "viewer/gl/shaders.h"

namespace ecorche {

const char* const shader_prelude = R"(
uniform vec3 u_eye, u_forward;
uniform float u_parallel;  // 1: parallel projection
uniform vec3 u_key_direction, u_key_color, u_sky_color, u_floor_color, u_rim_direction, u_rim_color;
uniform mat4 u_shadow;     // world -> shadow map [0,1]
uniform float u_shadow_strength, u_shadow_texel, u_shadow_world;
uniform sampler2DShadow u_shadow_map;

#ifdef QUICK
// Within 3/255 of what is below, without powers: polynomials in c, and in its roots.
vec3 to_linear(vec3 c) { return c * (c * (c * 0.3053 + 0.6822) + 0.0125); }
vec3 to_srgb(vec3 c) {
  vec3 r = sqrt(max(c, 0.0)), s = sqrt(r), t = sqrt(s);
  return max(0.6620 * r + 0.6841 * s - 0.3236 * t - 0.0225 * c, 0.0);
}
#else
vec3 to_linear(vec3 c) {
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));
}
vec3 to_srgb(vec3 c) {
  vec3 power = 1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055;
  return mix(12.92 * c, power, step(0.0031308, c));
}
#endif

float hash(vec2 p) {
  vec3 q = fract(p.xyx * 0.1031);
  q += dot(q, q.yzx + 33.33);
  return fract((q.x + q.y) * q.z);
}
float noise(vec2 p) {
  vec2 i = floor(p), f = fract(p);
  f = f * f * (3.0 - 2.0 * f);
  return mix(mix(hash(i), hash(i + vec2(1, 0)), f.x),
             mix(hash(i + vec2(0, 1)), hash(i + vec2(1, 1)), f.x), f.y);
}

// Share of the key light that reaches the point, which is first moved along its normal so that a
// surface does not shade itself.
float lit(vec3 p, vec3 n) {
#ifdef QUICK
  return 1.0;
#else
  if (u_shadow_strength <= 0.0) return 1.0;
  vec4 s = u_shadow * vec4(p + n * u_shadow_world * 1.8 - u_key_direction * u_shadow_world, 1.0);
  if (any(lessThan(s.xyz, vec3(0.0))) || any(greaterThan(s.xyz, vec3(1.0)))) return 1.0;
  const vec2 taps[8] = vec2[8](vec2(-0.33, 0.94), vec2(0.86, 0.51), vec2(-0.94, 0.16),
                               vec2(0.17, 0.33), vec2(-0.36, -0.29), vec2(0.61, -0.35),
                               vec2(-0.57, -0.82), vec2(0.22, -0.97));
  float sum = 0.0;
  for (int i = 0; i < 8; ++i)
    sum += texture(u_shadow_map, vec3(s.xy + taps[i] * 1.9 * u_shadow_texel, s.z));
  return mix(1.0, sum / 8.0, u_shadow_strength);
#endif
}

vec3 ambient(vec3 n) { return mix(u_floor_color, u_sky_color, 0.5 + 0.5 * n.y); }
vec3 view_direction(vec3 p) { return mix(normalize(u_eye - p), -u_forward, u_parallel); }
)";

const char* const surface_vertex = R"(
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec3 a_color;
layout(location = 3) in float a_occlusion;
layout(location = 4) in float a_dissolve;
layout(location = 5) in vec4 a_fibre;
layout(location = 6) in uint a_part;
uniform mat4 u_model, u_view_projection;
uniform mat3 u_normal;
uniform vec4 u_cut;  // drawn where dot(u_cut, place) is not below 0
out vec3 v_position, v_normal, v_color;
out float v_occlusion, v_dissolve;
out vec4 v_fibre;
flat out uint v_part;
void main() {
  vec4 p = u_model * vec4(a_position, 1.0);
  v_position = p.xyz;
  v_normal = u_normal * a_normal;
  v_color = to_linear(a_color);
  v_occlusion = a_occlusion;
  v_dissolve = a_dissolve;
  v_fibre = a_fibre;
  v_part = a_part;
  gl_Position = u_view_projection * p;
  gl_ClipDistance[0] = dot(u_cut, p);
#ifdef DISSOLVES
  // The remaining surface still covers surfaces that penetrate it by less than 0.03 m.
  vec3 v = view_direction(p.xyz);
  vec4 nearer = u_view_projection *
                vec4(p.xyz + 0.03 * smoothstep(0.0, 0.3, dot(normalize(v_normal), v)) * v, 1.0);
  gl_Position.z = nearer.z / nearer.w * gl_Position.w;
#endif
}
)";

const char* const surface_fragment = R"(
in vec3 v_position, v_normal, v_color;
in float v_occlusion, v_dissolve;
in vec4 v_fibre;
flat in uint v_part;
uniform float u_opacity, u_edge_opacity, u_dissolved;
uniform float u_roughness, u_specular, u_scatter, u_striation;
layout(location = 0) out vec4 o_color;
layout(location = 1) out uint o_part;
layout(location = 2) out vec4 o_normal;

// A height that is known at each pixel tilts the normal (Mikkelsen 2010): no tangents needed.
vec3 tilt(vec3 n, float height) {
  vec3 px = dFdx(v_position), py = dFdy(v_position);
  vec3 rx = cross(py, n), ry = cross(n, px);
  float det = dot(px, rx);
  vec3 g = sign(det) * (dFdx(height) * rx + dFdy(height) * ry);
  return normalize(abs(det) * n - g);
}

// Height of the fibre pattern, -1 .. 1, with `count` fibres around the belly. `angle`: around the
// belly, rad; `wander`: shift of the pattern.
float fibres(float count, float angle, float wander) {
  float phase = count * angle + 2.0 * wander;
  return 0.65 * cos(phase) + 0.35 * cos(3.0 * phase + 1.7 * sin(phase * 0.5));
}

// Fibres run along the belly. Fibres thinner than about four samples are drawn in bundles of two,
// four, ... instead. `turn`: change of the angle around the belly from one sample to the next.
float fibre_line() {
  float angle = atan(v_fibre.y, v_fibre.x);
  float wander = 0.35 * sin(31.0 * v_fibre.w + 3.0 * angle) +
                 0.25 * sin(83.0 * v_fibre.w - 5.0 * angle);
  float turn = length(vec2(length(dFdx(v_fibre.xy)), length(dFdy(v_fibre.xy)))) /
               max(length(v_fibre.xy), 0.1);
  float level = max(log2(max(v_fibre.z * turn, 1e-6) / 1.3), 0.0);
  float whole = floor(level), part = smoothstep(0.3, 0.7, level - whole);
  float fine = max(round(v_fibre.z / exp2(whole)), 3.0);
  float coarse = max(round(v_fibre.z / exp2(whole + 1.0)), 3.0);
  float fade = 1.0 - smoothstep(0.9, 2.0, coarse * turn);
  return fade * mix(fibres(fine, angle, wander), fibres(coarse, angle, wander), part);
}

float highlight(vec3 n, vec3 v, vec3 l, float roughness) {
  vec3 h = normalize(l + v);
  float a = roughness * roughness, a2 = a * a;
  float nh = max(dot(n, h), 0.0), nl = max(dot(n, l), 0.0);
  float nv = max(dot(n, v), 0.05), lh = max(dot(l, h), 0.05);
  float d = nh * nh * (a2 - 1.0) + 1.0;
  return nl * a2 / (3.14159 * d * d * 4.0 * lh * lh * (roughness + 0.5));
}

void main() {
  vec3 n = normalize(v_normal);
  vec3 v = view_direction(v_position);
#ifdef QUICK
  // What is left of the light below without shadow and highlight.
  if (!gl_FrontFacing) n = -n;
  vec3 soft = u_scatter * vec3(0.45, 0.20, 0.14);
  vec3 even = clamp((dot(n, -u_key_direction) + soft) / ((1.0 + soft) * (1.0 + soft)), 0.0, 1.0);
  float aside = 1.0 - max(dot(n, v), 0.0), aside2 = aside * aside;
  float share = clamp(u_opacity + u_edge_opacity * aside2, 0.0, 1.0);
  vec3 back = aside2 * aside * max(dot(n, -u_rim_direction) * 0.6 + 0.4, 0.0) * u_rim_color;
  vec3 seen = v_color * (u_key_color * even + ambient(n)) + back * mix(vec3(0.25), v_color, 0.55);
  o_color = vec4(seen * share, share);
  o_part = v_part;
  o_normal = vec4(0.5 + 0.5 * n, 1.0);
#else
  if (!gl_FrontFacing) n = -n;
  float edge = 0.0;
#ifdef DISSOLVES
  float left = v_dissolve - u_dissolved;
  if (left < 0.0) discard;
  edge = 1.0 - smoothstep(0.0, 0.012, left);
#endif
  vec3 base = v_color;
#ifdef HAS_FIBRES
  float line = fibre_line();
  base *= 1.0 + 0.12 * line;
  n = tilt(n, line * u_striation * 0.00020);
#endif
  base = mix(base, vec3(0.95, 0.80, 0.72), 0.6 * edge);

  vec3 key = -u_key_direction;
  float facing = dot(n, key);
  float shade = lit(v_position, normalize(v_normal) * (gl_FrontFacing ? 1.0 : -1.0));
  vec3 wrap = u_scatter * vec3(0.45, 0.20, 0.14);
  vec3 diffuse = clamp((facing + wrap) / ((1.0 + wrap) * (1.0 + wrap)), 0.0, 1.0);
  // Where flesh turns into shade, red light has travelled furthest.
  vec3 shadow_tint = mix(vec3(shade), vec3(pow(shade, 0.6), shade, shade), u_scatter);
  float open = v_occlusion;
  vec3 light = u_key_color * diffuse * shadow_tint * mix(1.0, open, 0.4) + ambient(n) * open;
  float grazing = 1.0 - max(dot(n, v), 0.0);
  float rim = pow(grazing, 3.0) * max(dot(n, -u_rim_direction) * 0.6 + 0.4, 0.0);
  vec3 color = base * light + rim * u_rim_color * open * mix(vec3(0.25), base, 0.55);
  float fresnel = u_specular + (1.0 - u_specular) * pow(grazing, 5.0) * (1.0 - u_roughness);
  color += u_key_color * fresnel / max(u_specular, 0.001) * u_specular *
           highlight(n, v, key, u_roughness) * shade;
  color += ambient(reflect(-v, n)) * fresnel * open * 0.35;
  float alpha = clamp(u_opacity + u_edge_opacity * pow(grazing, 2.0), 0.0, 1.0);
  o_color = vec4(color * alpha, alpha);
  o_part = v_part;
  o_normal = vec4(0.5 + 0.5 * n, 1.0);
#endif
}
)";

const char* const shadow_vertex = R"(
layout(location = 0) in vec3 a_position;
layout(location = 4) in float a_dissolve;
uniform mat4 u_model, u_view_projection;
uniform vec4 u_cut;
out float v_dissolve;
void main() {
  vec4 p = u_model * vec4(a_position, 1.0);
  v_dissolve = a_dissolve;
  gl_Position = u_view_projection * p;
  gl_ClipDistance[0] = dot(u_cut, p);
}
)";

const char* const shadow_fragment = R"(
in float v_dissolve;
uniform float u_dissolved;
void main() {
#ifdef DISSOLVES
  if (v_dissolve < u_dissolved) discard;
#endif
}
)";

const char* const screen_vertex = R"(
out vec2 v_uv;
void main() {
  v_uv = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
  gl_Position = vec4(2.0 * v_uv - 1.0, 1.0, 1.0);
}
)";

const char* const background_fragment = R"(
in vec2 v_uv;
uniform mat4 u_view_projection, u_unproject;
uniform vec3 u_top, u_bottom, u_ground_color;
uniform float u_ground_height, u_grid, u_board, u_lane, u_fade_distance;
uniform vec4 u_track;  // centre x, half width, begin z, end z
uniform vec3 u_pit;    // half width, begin z, end z
layout(location = 0) out vec4 o_color;

// Coverage of lines `width` metres wide at whole multiples of `step_`, filtered over the pixel's
// footprint.
float lines(float x, float step_, float width, float footprint) {
  float w = max(width, footprint);
  float d = abs(fract(x / step_ - 0.5) - 0.5) * step_;
  return (1.0 - smoothstep(0.5 * w - 0.5 * footprint, 0.5 * w + 0.5 * footprint, d)) *
         min(1.0, width / w);
}
float band(float x, float lo, float hi, float footprint) {
  float f = max(footprint, 1e-4);
  return smoothstep(lo - 0.5 * f, lo + 0.5 * f, x) *
         (1.0 - smoothstep(hi - 0.5 * f, hi + 0.5 * f, x));
}
float sand_height(vec2 p) {
  return 0.6 * noise(p * 11.0) + 0.3 * noise(p * 47.0) + 0.15 * noise(p * 190.0);
}

void main() {
  vec3 back = mix(u_bottom, u_top, smoothstep(0.15, 1.0, v_uv.y));
  back = to_linear(back);
#ifdef EMPTY
  o_color = vec4(back, 1.0);
  gl_FragDepth = 1.0;
#else
  vec4 a = u_unproject * vec4(2.0 * v_uv - 1.0, -1.0, 1.0);
  vec4 b = u_unproject * vec4(2.0 * v_uv - 1.0, 1.0, 1.0);
  vec3 from = a.xyz / a.w, ray = normalize(b.xyz / b.w - from);
  float t = (u_ground_height - from.y) / ray.y;
  // The backdrop of a studio: the floor runs into it without a horizon.
  vec3 p = from + t * ray;
  vec2 fx = fwidth(p.xz);
  bool sky = t <= 0.0 || t > 190.0 || from.y < u_ground_height;
  vec3 n = vec3(0, 1, 0);
  vec3 base = to_linear(u_ground_color);
#ifndef QUICK
  base *= 1.0 + 0.05 * (noise(p.xz * 3.0) - 0.5);
#endif
  if (u_grid > 0.0)
    base *= 1.0 - 0.16 * max(lines(p.x, u_grid, 0.012, fx.x), lines(p.z, u_grid, 0.012, fx.y));
#ifndef PLAIN
  if (u_track.w > u_track.z) {
    float x = abs(p.x - u_track.x);
    float on = band(p.z, u_track.z, u_track.w, fx.y);
    float speckle = noise(p.xz * 140.0) - 0.5;
    vec3 tartan = to_linear(vec3(0.66, 0.29, 0.22)) *
                  (1.0 + 0.22 * speckle * (1.0 - smoothstep(0.003, 0.02, max(fx.x, fx.y))));
    tartan *= 1.0 - 0.10 * lines(p.z, u_grid, 0.015, fx.y);
    base = mix(base, tartan,
               on * (1.0 - smoothstep(u_track.y - 0.5 * fx.x, u_track.y + 0.5 * fx.x, x)));
    float across = p.x - u_track.x + u_track.y;
    base = mix(base, vec3(0.85), on * band(x, u_track.y - 0.05, u_track.y, fx.x));
    if (u_lane < u_track.y * 1.9)
      base = mix(base, vec3(0.85),
                 on * step(x, u_track.y - 0.1) * lines(across, u_lane, 0.05, fx.x));
    if (u_board != 0.0) {
      float inside = 1.0 - smoothstep(u_track.y - 0.05 - 0.5 * fx.x,
                                      u_track.y - 0.05 + 0.5 * fx.x, x);
      base = mix(base, vec3(0.88), inside * band(p.z, u_board - 0.20, u_board, fx.y));
      base = mix(base, to_linear(vec3(0.30, 0.62, 0.42)),
                 inside * band(p.z, u_board, u_board + 0.10, fx.y));
    }
  }
  if (u_pit.z > u_pit.y) {
    float in_pit = band(p.x - u_track.x, -u_pit.x, u_pit.x, fx.x) *
                   band(p.z, u_pit.y, u_pit.z, fx.y);
    float frame = band(p.x - u_track.x, -u_pit.x - 0.08, u_pit.x + 0.08, fx.x) *
                  band(p.z, u_pit.y - 0.08, u_pit.z + 0.08, fx.y);
    base = mix(base, to_linear(vec3(0.55, 0.53, 0.50)), frame);
    float detail = 1.0 - smoothstep(0.01, 0.08, max(fx.x, fx.y));
    float h = sand_height(p.xz), e = 0.012;
    vec2 slope = vec2(sand_height(p.xz + vec2(e, 0)) - h, sand_height(p.xz + vec2(0, e)) - h) / e;
    vec3 sand = to_linear(vec3(0.86, 0.76, 0.58)) * (0.88 + 0.24 * h);
    base = mix(base, sand, in_pit);
    vec3 ripple = normalize(vec3(-0.035 * slope.x * detail, 1.0, -0.035 * slope.y * detail));
    n = normalize(mix(n, ripple, in_pit));
  }
#endif
#ifdef SUNNY
  float shade = 1.0;
#else
  float shade = lit(p, vec3(0, 1, 0));
#endif
  vec3 light = u_key_color * max(dot(n, -u_key_direction), 0.0) * shade + ambient(n) * 0.9;
  vec3 color = base * light * 0.62;
  float distance_ = length(p - u_eye);
  color = mix(color, back, smoothstep(0.35, 1.0, distance_ / u_fade_distance));
  o_color = vec4(sky ? back : color, 1.0);
#ifndef QUICK
  vec4 clip = u_view_projection * vec4(p, 1.0);
  float depth = 0.5 + 0.5 * clip.z / clip.w;
  gl_FragDepth = sky || depth > 0.999998 ? 1.0 : max(depth, 0.0);
#endif
#endif
}
)";

const char* const occlusion_fragment = R"(
uniform sampler2D u_depth, u_normals, u_ground_depth;
uniform mat4 u_view_projection, u_unproject;
uniform vec2 u_pixel;  // of this picture
uniform int u_samples;
uniform float u_radius;
uniform vec4 u_ball;  // around the figure
layout(location = 0) out vec4 o_open;

// Depth of the nearer of figure and ground. The figure has several samples a pixel; one is read.
float depth_at(ivec2 at) {
  return min(texelFetch(u_depth, at * u_samples, 0).r, texelFetch(u_ground_depth, at, 0).r);
}
vec3 world(vec2 at, float depth) {
  vec4 p = u_unproject * vec4(2.0 * vec3((at + 0.5) * u_pixel, depth) - 1.0, 1.0);
  return p.xyz / p.w;
}

// Ambient occlusion in screen space: the share of the sky that is open. The horizon is sampled
// along six directions on the screen at three distances each; its angle over the surface is
// measured in the world. Directions turn with a 4 x 4 pattern of pixels, which the blur averages
// out.
void main() {
  ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(u_ground_depth, 0) - 1;
  float own = texelFetch(u_depth, here * u_samples, 0).r;
  float ground = texelFetch(u_ground_depth, here, 0).r;
  float depth = min(own, ground);
  if (depth > 0.9999985) {  // nothing there
    o_open = vec4(1.0);
    return;
  }
  vec3 p = world(vec2(here), depth);
  // Far from the figure there is nothing to close the sky, and depths are too coarse to tell.
  float near = 1.0 - smoothstep(1.1 * u_ball.w, 1.3 * u_ball.w, length(p - u_ball.xyz));
  if (near <= 0.0) {
    o_open = vec4(1.0);
    return;
  }
  vec3 n = own <= ground ? normalize(texelFetch(u_normals, here * u_samples, 0).xyz - 0.5)
                         : vec3(0, 1, 0);
  vec4 clip = u_view_projection * vec4(p, 1.0);
  vec3 side = vec3(u_view_projection[0][0], u_view_projection[1][0], u_view_projection[2][0]);
  vec3 upward = vec3(u_view_projection[0][1], u_view_projection[1][1], u_view_projection[2][1]);
  vec2 reach = 0.5 * u_radius * vec2(length(side), length(upward)) / clip.w / u_pixel;
  ivec2 cell = here & 3;
  int index = cell.x * 4 + cell.y;
  float turn = float((index * 7) & 15) / 16.0, jitter = float((index * 11 + 5) & 15) / 16.0;
  float closed = 0.0;
  for (int i = 0; i < 6; ++i) {
    float angle = 6.2831853 * (float(i) + turn) / 6.0;
    vec2 step_ = vec2(cos(angle), sin(angle)) * reach;
    float horizon = 0.0;
    for (int k = 0; k < 3; ++k) {
      float share = (float(k) + 0.25 + 0.75 * jitter) / 3.0;
      ivec2 at = clamp(here + ivec2(round(step_ * share * share)), ivec2(0), last);
      vec3 d = world(vec2(at), depth_at(at)) - p;
      float l = length(d);
      float rise = dot(d, n) / max(l, 1e-6) - 0.06;
      horizon = max(horizon, rise * (1.0 - smoothstep(0.5 * u_radius, 1.4 * u_radius, l)));
    }
    closed += horizon;
  }
  o_open = vec4(clamp(1.0 - 1.15 * near * closed / 6.0, 0.0, 1.0));
}
)";

const char* const occlusion_blur_fragment = R"(
uniform sampler2D u_open, u_depth, u_ground_depth;
uniform int u_samples;
layout(location = 0) out vec4 o_open;

float depth_at(ivec2 at) {
  return min(texelFetch(u_depth, at * u_samples, 0).r, texelFetch(u_ground_depth, at, 0).r);
}

// 4 x 4 box that does not cross edges of depth.
void main() {
  ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(u_open, 0) - 1;
  float depth = depth_at(here);
  float sum = 0.0, weight = 0.0;
  float limit = 0.02 * max(1.0 - depth, 1e-6);
  for (int y = -2; y < 2; ++y)
    for (int x = -2; x < 2; ++x) {
      ivec2 at = clamp(here + ivec2(x, y), ivec2(0), last);
      float w = abs(depth_at(at) - depth) < limit ? 1.0 : 0.02;
      sum += w * texelFetch(u_open, at, 0).r;
      weight += w;
    }
  o_open = vec4(sum / weight);
}
)";

const char* const resolve_fragment = R"(
uniform sampler2D u_color, u_open, u_ground;
uniform usampler2D u_parts;
uniform int u_samples;
uniform float u_outline;
layout(location = 0) out vec4 o_color;

// The curve leaves the middle alone and bends highlights, so that wet flesh does not burn out.
vec3 tone(vec3 c) {
  vec3 x = max(c, 0.0);
  return x * (1.0 + x * 0.16) / (1.0 + x * 0.46);
}

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec3 ground = texelFetch(u_ground, here, 0).rgb;
#ifdef QUICK
  const vec3 shade = vec3(1.0);
#else
  // The shade of flesh stays warm.
  float open = texelFetch(u_open, here, 0).r;
  vec3 shade = pow(vec3(open), vec3(1.05, 1.25, 1.3));
#endif
#ifdef FIGURE
#ifdef QUICK
  const int samples = 1;
#else
  int samples = u_samples;
#endif
  ivec2 origin = here * samples;
  ivec2 last = textureSize(u_parts, 0) - 1;
  vec3 sum = vec3(0.0);
#ifdef TRANSPARENT
  float covered = 0.0;
#endif
  for (int y = 0; y < samples; ++y)
    for (int x = 0; x < samples; ++x) {
      ivec2 at = origin + ivec2(x, y);
      vec4 c = texelFetch(u_color, at, 0);
#ifdef TRANSPARENT
      vec3 seen = c.a * tone(shade * c.rgb / max(c.a, 1e-4));
      covered += c.a;
#else
      vec3 seen = tone(shade * (c.rgb + (1.0 - c.a) * ground));
#endif
      uint part = texelFetch(u_parts, at, 0).r;
      uint right = texelFetch(u_parts, min(at + ivec2(1, 0), last), 0).r;
      uint above = texelFetch(u_parts, min(at + ivec2(0, 1), last), 0).r;
      bool line = part != 0u && ((right != part && right != 0u) || (above != part && above != 0u));
      sum += line ? seen * (1.0 - u_outline) : seen;
    }
#ifdef TRANSPARENT
  sum /= max(covered, 1e-4);
  float alpha = covered / float(samples * samples);
#else
  sum /= float(samples * samples);
  const float alpha = 1.0;
#endif
#else
  vec3 sum = tone(ground * shade);
  const float alpha = 1.0;
#endif
  o_color = vec4(to_srgb(clamp(sum, 0.0, 1.0)), alpha);
}
)";

}  // namespace ecorche
