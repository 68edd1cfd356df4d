/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/shaders.h -- what runs on the graphics card (GLSL 3.30). */
#ifndef VIEWER_SHADERS_H
#define VIEWER_SHADERS_H

extern const char *const shader_patch_vertex;
extern const char *const shader_smooth_fragment, *const shader_flat_fragment;
extern const char *const shader_false_smooth_fragment, *const shader_false_flat_fragment;
extern const char *const shader_back_fragment, *const shader_resolve_fragment;
extern const char *const shader_resolve_light_fragment;
extern const char *const shader_line_vertex, *const shader_line_fragment;
extern const char *const shader_picture_vertex, *const shader_picture_fragment;

#endif
