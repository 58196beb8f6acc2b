/* SPDX-License-Identifier: MIT
 *
 * The steps of gbuffer_load. */
#ifndef VKAO_TOOLS_GBUFFER_INTERNAL_H_
#define VKAO_TOOLS_GBUFFER_INTERNAL_H_

#include "camera_fit.h"
#include "gbuffer.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Statistics look at this many texels at most, spread evenly. */
enum { GBUFFER_MAX_SAMPLES = 1 << 18 };
/* Of edges with texels in between; more is said. */
#define GBUFFER_MOST_FILTERED 0.3

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

/* Of the whole image as it is seen: pixels may not be square. */
static inline double gbuffer_aspect(const struct gbuffer *g)
{
    const double width = (double)g->display_window.x_max - g->display_window.x_min + 1.0;
    const double height = (double)g->display_window.y_max - g->display_window.y_min + 1.0;
    return width * (double)g->pixel_aspect / height;
}

/* Times a matrix of columns. */
static inline void gbuffer_turn_normal(const float m[9], const float *n, double out[3])
{
    for (int row = 0; row < 3; row++)
        out[row] = (double)m[row] * (double)n[0] + (double)m[3 + row] * (double)n[1] +
                   (double)m[6 + row] * (double)n[2];
}

/* A normal as it is used, in view space. */
static inline void gbuffer_view_normal(const struct gbuffer *g, size_t texel, double v[3])
{
    gbuffer_turn_normal(g->view.normal_to_view, g->normals + texel * 4, v);
}

/* Of a normal. */
static inline double gbuffer_length(const float *n)
{
    const double x = (double)n[0], y = (double)n[1], z = (double)n[2];
    return sqrt(x * x + y * y + z * z);
}

/* The square of how far two normals are from each other. */
static inline double gbuffer_apart(const float *a, const float *b)
{
    double sum = 0;
    for (int c = 0; c < 3; c++)
        sum += ((double)a[c] - (double)b[c]) * ((double)a[c] - (double)b[c]);
    return sum;
}

/* The user said so. */
static inline bool gbuffer_camera_is_explicit(const struct camera *camera)
{
    return camera->source[0] == '-' || strcmp(camera->source, "camera file") == 0;
}

/* Of normals in camera space, with z towards the eye or away from it. */
static inline bool gbuffer_is_camera_rotation(const double r[9])
{
    return r[0] > 0.9999 && r[4] > 0.9999 && fabs(r[8]) > 0.9999;
}

bool gbuffer_same_box(const struct exr_box *a, const struct exr_box *b);
/* SIZE_MAX if they are too many to count. */
size_t gbuffer_box_texels(const struct exr_box *box);
/* malloc'ed; NULL and EXIT_MEMORY, which names the path, if memory ran out. */
float *gbuffer_allocate(size_t texels, size_t components, const char *path, struct tool_error *err);
/* A role with so many floats per texel in the window of the depth; missing: a fourth component that
 * is not there, and what the role's own window lacks. malloc'ed; NULL on error. */
float *gbuffer_read_role(const struct gbuffer *g, const struct role *role, size_t components,
                         float missing, struct tool_error *err);
/* Alpha is 1 where there is none. */
void gbuffer_complete_alpha(const struct gbuffer *g, float *color, size_t texels);

/* The camera by positions, width * height * 4, whose background becomes 0, and depth from them if
 * it is DEPTH_POSITION, which it is no longer then. Errors: EXIT_CHANNELS, EXIT_MEMORY. */
bool gbuffer_use_positions(struct gbuffer *g, const struct gbuffer_options *options,
                           float *positions, const char *path, struct report *report,
                           struct tool_error *err);
/* What depth measures is left to the image. */
bool gbuffer_type_is_auto(const struct gbuffer *g, const struct gbuffer_options *options);
/* How a camera is looked for. */
struct camera_search {
    unsigned models;        /* what depth may be: 1 << enum fit_model or-ed; 0: nothing is found */
    bool is_known;          /* through the camera that is known */
    double near_half_width; /* else near this; 0: anywhere */
    enum fit_patch patch;   /* ANY: that which tells most */
};
/* False only if memory runs out. */
bool gbuffer_fit_camera(const struct gbuffer *g, const struct camera_search *search,
                        struct fit *fit, struct tool_error *err);
/* The same, and of scale: no more is sure than the type of depth allows. */
bool gbuffer_estimate(const struct gbuffer *g, const struct camera_search *search, struct fit *fit,
                      struct tool_error *err);
/* Of all that depth may be; through any camera, and through the one that is known. */
bool gbuffer_estimate_anywhere(const struct gbuffer *g, const struct gbuffer_options *options,
                               struct fit *fit, struct tool_error *err);
bool gbuffer_estimate_known(const struct gbuffer *g, const struct gbuffer_options *options,
                            enum fit_patch patch, struct fit *fit, struct tool_error *err);
/* Of depth that is 1/z, without perspective; nothing if somebody says otherwise. */
bool gbuffer_estimate_parallel(const struct gbuffer *g, const struct gbuffer_options *options,
                               bool is_known, struct fit *fit, struct tool_error *err);
/* Anywhere, of single normals. */
bool gbuffer_estimate_single(const struct gbuffer *g, const struct gbuffer_options *options,
                             struct fit *fit, struct tool_error *err);
/* Whether depth as stored is turned round against the normals, which says so and fills g->flip;
 * fit: of the two as they are, through the camera that is known or any; becomes that of depth once
 * it is turned. Errors: EXIT_MEMORY. */
bool gbuffer_find_flip(struct gbuffer *g, const struct gbuffer_options *options, bool is_known,
                       struct fit *fit, const char *path, struct report *report,
                       struct tool_error *err);
/* What else than somebody tells depth may be through the camera that is known; other->is_sure if
 * normals say so. False only if memory runs out. */
bool gbuffer_find_type(const struct gbuffer *g, const struct gbuffer_options *options,
                       const struct fit *told, struct fit *other, struct tool_error *err);
/* Takes the other depth of the file if that is the one in scene units; says if the two differ. */
void gbuffer_compare_depths(struct gbuffer *g, const struct gbuffer_options *options,
                            struct report *report);
/* Says of what is taken as 1/z, told or not, that by normals it is 1 over another distance. False
 * only if memory runs out. */
bool gbuffer_doubt_inverse(const struct gbuffer *g, const struct gbuffer_options *options,
                           const char *path, struct report *report, struct tool_error *err);
/* Who says what depth measures, in words, if somebody does. */
const char *gbuffer_teller_of_type(const struct gbuffer *g, const struct gbuffer_options *options);
void gbuffer_tell_type(const struct gbuffer *g, const struct gbuffer_options *options,
                       const struct fit *told, const struct fit *other, const char *path,
                       struct report *report);
/* What is not known of the camera by now, and of the type of depth, from depth and normals as read;
 * and says so. Errors: EXIT_MEMORY. */
bool gbuffer_find_camera(struct gbuffer *g, const struct gbuffer_options *options, const char *path,
                         struct report *report, struct tool_error *err);
/* No scene measures more or less than this, in whatever unit. Within, squares are finite and not
 * 0. */
bool gbuffer_is_in_range(double distance);
/* In range, and not what renderers write where there is nothing: Falcor, Cycles, clip ranges, and
 * what compression makes of it. */
bool gbuffer_is_measurable(double distance);
/* Of a depth as stored; not finite or not positive where it is none. */
double gbuffer_distance(const struct gbuffer *g, float depth);
/* How much longer the ray of a texel is than its way along the view axis. */
double gbuffer_ray_length(const struct gbuffer *g, size_t texel);

/* Whether depth as stored is background all over, by its values alone, by the far plane, alpha or
 * the frames before; and whether positions, of three floats in four, are one point. */
bool gbuffer_is_empty(const struct gbuffer *g, const struct gbuffer_options *options);
bool gbuffer_is_one_point(const struct gbuffer *g, const float *positions);
/* Fills g->background; needs depth as stored, normals and alpha. False if memory ran out. */
bool gbuffer_find_background(struct gbuffer *g, const struct gbuffer_options *options);

/* That contradict what is believed: fewer, as those that steps of halves leave, are of what bends
 * most. */
enum { GBUFFER_ENOUGH_TRIPLES = 500 };
/* Needs depth as stored and its background. False if memory ran out. */
bool gbuffer_read_planes(const struct gbuffer *g, struct depth_planes *planes);
/* The power of normalised depth by which flat things are flat, or 1; needs g->planes. False if
 * memory ran out. */
bool gbuffer_find_gamma(const struct gbuffer *g, double *gamma);
/* Of depth as stored that was bent by gamma or a logarithm, which the planes tell. False if memory
 * ran out. */
bool gbuffer_warn_of_curve(struct gbuffer *g, const char *path, struct report *report);
/* Share of edges of the depth, as stored, that have a texel in between, as filters make them. */
double gbuffer_filtered_share(const struct gbuffer *g);
/* The step of depth, as stored, that all of it is multiples of, or 0. False if memory ran out. */
bool gbuffer_find_step(const struct gbuffer *g, double *step);
/* Of depth as stored, whatever its channel is: it was one of halves before. */
bool gbuffer_holds_halves(const struct gbuffer *g);
/* Of depth as stored: 1, or what it was enlarged by without interpolation. */
unsigned gbuffer_block_size(const struct gbuffer *g);
/* The same of normals, once they are decoded; no whole number perhaps. */
double gbuffer_enlargement_of_normals(const struct gbuffer *g);
/* Of depth as stored: 1, or the side of the square whose nearest or farthest value each texel
 * has. */
unsigned gbuffer_ridge_width(const struct gbuffer *g);
/* Of depth as prepared, unless a camera is given by hand. */
void gbuffer_warn_of_panorama(const struct gbuffer *g, const char *path, struct report *report);
/* Of depth as prepared and the normals that are used, if any, where these belong to other texels.
 * False if memory ran out. */
bool gbuffer_warn_of_move(const struct gbuffer *g, const char *path, struct report *report);
/* Of depth as prepared and the normals that are used, if any, unless filtered_share says enough;
 * becomes part of that. */
void gbuffer_warn_of_ramps(struct gbuffer *g, const char *path, struct report *report);
/* Of depth as prepared and the normals that are used, if any: values that all beyond them was set
 * to, or that what lies in between was filled with. False if memory runs out. */
bool gbuffer_warn_of_limits(const struct gbuffer *g, const char *path, struct report *report);
/* Of depth as prepared, of another kind or unit than that of the frames before, where that begins;
 * memory may be NULL. */
void gbuffer_warn_of_frame(const struct gbuffer *g, struct frame_memory *memory, const char *path,
                           struct report *report);
/* Of depth as prepared and the normals that are used, if any. */
void gbuffer_warn_of_borders(const struct gbuffer *g, const char *path, struct report *report);
/* Of depth as prepared and the normals that are used, if any: lines and buckets of the image along
 * which depth breaks, and normals do not. */
void gbuffer_warn_of_breaks(const struct gbuffer *g, const char *path, struct report *report);
/* Of depth as prepared, with its alpha, and the normals that are used, if any: where only one of
 * the two is there. */
void gbuffer_warn_of_holes(const struct gbuffer *g, const char *path, struct report *report);
/* Of depth as prepared, with its alpha, and the normals that are used, if any, where alpha was
 * multiplied into these. */
void gbuffer_warn_of_opacity(const struct gbuffer *g, const char *path, struct report *report);
/* Of depth as prepared and the normals that are used, if any: single things whose normals are not
 * those of their depth. False if memory ran out. */
bool gbuffer_warn_of_strangers(const struct gbuffer *g, const char *path, struct report *report);
/* Those of view, move, limits, holes, opacity, borders, breaks and strangers, on as many cores as
 * there are; said in this order, the last three unless there is a move. */
bool gbuffer_run_checks(const struct gbuffer *g, const char *normals_path, struct report *report,
                        struct tool_error *err);
/* By how many widths of a texel depth, as prepared, bends where stored normals are alike: a median,
 * 0 where there are few of them. False if memory ran out. */
bool gbuffer_measure_noise(const struct gbuffer *g, double *noise);

/* Of a layer beside the depth as stored. */
struct layer_signs {
    size_t values, opposite; /* those that measure something, and those of the other sign */
    double low, high;        /* of the latter */
};
struct layer_signs gbuffer_look_at_signs(const struct gbuffer *g, const float *values,
                                         bool is_negated);
/* Says what cannot be behind the depth; fills second_min_z. Needs all of it as prepared, and the
 * signs before. Errors: EXIT_CHANNELS, of what is in front; EXIT_MEMORY. */
bool gbuffer_check_behind(struct gbuffer *g, const struct layer_signs *thickness,
                          const struct layer_signs *second, struct report *report,
                          struct tool_error *err);

/* The largest of 8, 16, 24 or 32 bits, whichever holds it: what whole numbers are parts of. */
double gbuffer_full_range(double most);
/* The least that is not below most of the numbers whose bits are all set, from least on, which is
 * one. */
double gbuffer_all_bits(double most, double least);
/* Objects that do not cast are not there, in depth as prepared; and g->holdout. */
bool gbuffer_take_out(const struct exr_info *info, struct gbuffer *g,
                      const struct gbuffer_options *options, struct report *report,
                      struct tool_error *err);
bool gbuffer_read_holdout(const struct exr_info *info, struct gbuffer *g,
                          const struct gbuffer_options *options, struct report *report,
                          struct tool_error *err);

/* Decoded normals have the 256 steps of a picture, which make round things flat. */
bool gbuffer_are_normals_of_bytes(const struct gbuffer *g);

/* DEVICE or NORMALIZED, if depth is from 0 to 1, no --depth-type is given and what its ends stand
 * for is; else AUTO. Needs depth as stored. Errors: EXIT_MEMORY. */
bool gbuffer_find_told_ends(struct gbuffer *g, const struct gbuffer_options *options,
                            enum depth_type *type, struct report *report, struct tool_error *err);
/* Turns negative z round. */
void gbuffer_turn_depth(struct gbuffer *g, const struct gbuffer_options *options,
                        struct report *report);
/* Fills depth_type and depth_source; needs depth as stored. Errors:
 * EXIT_CHANNELS with a remedy, EXIT_MEMORY. */
bool gbuffer_resolve_depth_type(struct gbuffer *g, const struct exr_info *info,
                                const struct gbuffer_options *options, struct report *report,
                                struct tool_error *err);
/* Depth, thickness and second depth as read become what the library takes; fills projection and
 * statistics, which are those of the depth. */
bool gbuffer_prepare_depth(struct gbuffer *g, const struct exr_info *info,
                           const struct gbuffer_options *options, struct report *report,
                           struct tool_error *err);
/* What depth has for a normal at a texel, in view space, and what is stored there. */
struct normal_pair {
    double depth[3], stored[3], weight;
    size_t texel;
};
struct normal_pairs {
    struct normal_pair *pair;
    size_t count, reach; /* of the neighbours that lie on the plane of depth, in texels */
};
enum { GBUFFER_MOST_PAIRS = 1 << 16 };
/* At most so many, spread evenly. Needs the depth as prepared, and decoded normals. False if memory
 * ran out. */
bool gbuffer_pair_normals(const struct gbuffer *g, size_t most, struct normal_pairs *pairs);
/* The same, and of what is round, which is less sure. */
bool gbuffer_pair_round_normals(const struct gbuffer *g, size_t most, struct normal_pairs *pairs);
/* Of depth as prepared, from the neighbours that are most alike, in view space; nearly right on
 * narrow things too. False where there are none. */
bool gbuffer_rough_normal(const struct gbuffer *g, size_t texel, double n[3]);
/* The same where depth is smooth, flat or round. False where it is not. */
bool gbuffer_smooth_normal(const struct gbuffer *g, size_t texel, double n[3]);
void gbuffer_free_pairs(struct normal_pairs *pairs);
/* Of stored normals, times the matrix (of columns), with those of depth. 0 without pairs. */
struct agreement {
    double share;  /* [0,1], whichever way the normals point */
    double facing; /* [0,1] of them point as those of depth do */
};
struct agreement gbuffer_agreement(const struct normal_pairs *pairs, const float matrix[9]);

/* Says that another field of view fits the normals better, turned as they are. Needs them and the
 * depth as prepared. False if memory ran out. */
bool gbuffer_warn_of_view(const struct gbuffer *g, const char *path, struct report *report);

/* Of decoded normals, times a matrix of columns that turns them into view space. */
struct normal_facing {
    double share;    /* of normals that face the eye */
    size_t away;     /* that do not */
    double median_z; /* positive: towards the eye */
};
/* False if memory ran out, as of the two below. */
bool gbuffer_measure_facing(const struct gbuffer *g, const float matrix[9],
                            struct normal_facing *facing);
/* All three axes the other way round. */
void gbuffer_turn_round(float m[9]);
/* Turn round what is mirrored, or inside out, as it is turned into view space by now; and say
 * so. */
bool gbuffer_ask_mirrors(struct gbuffer *g, const struct normal_pairs *pairs, const char *path,
                         struct report *report);
bool gbuffer_ask_whether_inside_out(struct gbuffer *g, const struct normal_pairs *pairs,
                                    const char *path, struct report *report);
/* Single normals that face away, where depth faces the other way; and says so if they are many. */
bool gbuffer_turn_to_eye(struct gbuffer *g, const char *path, struct report *report);

/* Normals are those of depth from now on. */
void gbuffer_drop_normals(struct gbuffer *g);
/* Decides and undoes the encoding of g->normals as read. */
bool gbuffer_decode_normals(struct gbuffer *g, enum normal_encoding wanted, const char *path,
                            struct report *report, struct tool_error *err);
/* Of decoded normals before they are of unit length: those that a matrix was applied to. */
void gbuffer_warn_of_matrix(const struct gbuffer *g, const char *path, struct report *report);
/* Of decoded normals without a negative component: how many must have had one. 0 of others. */
size_t gbuffer_count_lost_signs(const struct gbuffer *g, const struct normal_pairs *pairs);
/* Of so many; needs the agreement of the normals. */
void gbuffer_warn_of_lost_signs(const struct gbuffer *g, size_t lost, const char *path,
                                struct report *report);
/* Needs the depth and decoded normals: finds their space, or frees them. */
bool gbuffer_prepare_normals(struct gbuffer *g, const struct gbuffer_options *options,
                             const char *path, struct report *report, struct tool_error *err);

#endif
