// GLSL sources. A driver in software tests depth before it shades only where no fragment is thrown
// away, and takes both sides of a branch: so what not every mesh needs is a variant of the program,
// made by a #define.
#pragma once

namespace ecorche {

extern const char* const shader_prelude;  // light and colour functions; goes before every source
extern const char* const surface_vertex;
extern const char* const surface_fragment;
extern const char* const shadow_vertex;
extern const char* const shadow_fragment;
extern const char* const screen_vertex;
extern const char* const background_fragment;  // gradient and ground
extern const char* const occlusion_fragment;
extern const char* const occlusion_blur_fragment;
extern const char* const resolve_fragment;

}  // namespace ecorche
