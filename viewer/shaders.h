/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/shaders.h -- what runs on the graphics card (GLSL 3.30). */
#ifndef VIEWER_SHADERS_H
#define VIEWER_SHADERS_H

extern const char *const shader_patch_vertex, *const shader_patch_fragment;
extern const char *const shader_line_vertex, *const shader_line_fragment;
extern const char *const shader_picture_vertex, *const shader_picture_fragment;

#endif
