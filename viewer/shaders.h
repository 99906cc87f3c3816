// GLSL sources. Each full-screen pass shares one vertex stage; surfaces share one with the shadow pass.
#pragma once

namespace ecorche {

extern const char* const shader_prelude;       // version, light and colour functions; goes before every source
extern const char* const surface_vertex;
extern const char* const surface_fragment;
extern const char* const shadow_vertex;
extern const char* const shadow_fragment;
extern const char* const screen_vertex;
extern const char* const background_fragment;  // gradient and ground
extern const char* const occlusion_fragment;
extern const char* const occlusion_apply_fragment;
extern const char* const resolve_fragment;

}  // namespace ecorche
