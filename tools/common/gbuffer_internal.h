/* SPDX-License-Identifier: MIT
 *
 * The steps of gbuffer_load. */
#ifndef VKAO_TOOLS_GBUFFER_INTERNAL_H_
#define VKAO_TOOLS_GBUFFER_INTERNAL_H_

#include "gbuffer.h"

#include <stddef.h>

/* Statistics look at this many texels at most, spread evenly. */
enum { GBUFFER_MAX_SAMPLES = 1 << 18 };

static inline size_t gbuffer_texels(const struct gbuffer *g)
{
    return (size_t)g->width * g->height;
}

static inline size_t gbuffer_sample_step(const struct gbuffer *g)
{
    return gbuffer_texels(g) / GBUFFER_MAX_SAMPLES + 1;
}

static inline bool gbuffer_is_foreground(const struct gbuffer *g, size_t texel)
{
    return !(g->depth[texel] <= g->background_depth && g->depth[texel] >= g->background_depth);
}

/* The camera by positions, width * height * 4, and depth from them if it is DEPTH_POSITION, which
 * it is no longer then. Errors: EXIT_CHANNELS, EXIT_MEMORY. */
bool gbuffer_use_positions(struct gbuffer *g, const struct gbuffer_options *options,
                           const float *positions, const char *path, struct report *report,
                           struct tool_error *err);
/* What is not known of the camera by now, and of the type of depth, from depth and normals as read;
 * and says so. Errors: EXIT_MEMORY. */
bool gbuffer_find_camera(struct gbuffer *g, const struct gbuffer_options *options, const char *path,
                         struct report *report, struct tool_error *err);
/* Depth, thickness and second depth as read become what the library takes; fills projection and
 * statistics, which are those of the depth. */
bool gbuffer_prepare_depth(struct gbuffer *g, const struct gbuffer_options *options,
                           const char *path, struct report *report, struct tool_error *err);
/* Needs the depth. g->normals as read becomes signed, or is freed. */
bool gbuffer_prepare_normals(struct gbuffer *g, const struct gbuffer_options *options,
                             const char *path, struct report *report, struct tool_error *err);

#endif
