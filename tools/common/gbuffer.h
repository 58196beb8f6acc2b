/* SPDX-License-Identifier: MIT
 *
 * One view of one EXR file, loaded and made ready for the library: depth cleaned and in one of its
 * encodings, normals signed, colour as RGBA, all in the data window of the depth, and the struct
 * ao_view that describes them. */
#ifndef VKAO_TOOLS_GBUFFER_H_
#define VKAO_TOOLS_GBUFFER_H_

#include "budget.h"
#include "camera.h"
#include "error.h"
#include "exr_file.h"
#include "report.h"
#include "roles.h"
#include "setting.h"

#include <stdbool.h>
#include <stdint.h>

/* What --background says. */
enum background_rule { BACKGROUND_AUTO, BACKGROUND_OFF, BACKGROUND_GIVEN };

/* By what distances from a limit on are background. */
enum background_reason {
    BACKGROUND_NONE,        /* none are */
    BACKGROUND_GIVEN_VALUE, /* --background */
    BACKGROUND_FAR_PLANE,   /* it is that of the camera */
    BACKGROUND_ALPHA,       /* alpha is 0 there */
    BACKGROUND_NO_NORMALS,  /* normals are 0 there, or none of a wall */
    BACKGROUND_FAR,         /* always the same, and far behind all else */
    BACKGROUND_DOUBT        /* always the same, but not so far: taken for a wall */
};

struct background {
    enum background_reason reason;
    double limit;         /* in the unit of depth; INFINITY if there is none */
    double value, gap;    /* that repeats, and how many times as far as all else it is */
    double share;         /* [0,1] of the texels with that value */
    size_t cut;           /* texels that measure a given value or more */
    double cut_share;     /* [0,1] of the texels that show no sky: those that do so */
    bool is_amid_surface; /* as a given value is that surfaces go on through */
    bool is_doubtful;     /* say so */
    bool is_transparent;  /* so is where alpha is 0 */
    bool has_point;       /* and so is this value alone, as stored, though things lie beyond */
    float point;
};

/* What depth is, and who says so. */
enum depth_source {
    DEPTH_ASSUMED,
    DEPTH_BY_OPTION,
    DEPTH_BY_NAME,
    DEPTH_BY_PLANES,     /* flat things are flat */
    DEPTH_BY_NORMALS,    /* those of depth are the stored ones */
    DEPTH_BY_POSITIONS,  /* it was none */
    DEPTH_BY_CONVENTION, /* of the program that wrote the file */
    DEPTH_BY_CAMERA,     /* the camera file says so */
    DEPTH_BY_ENDS        /* --near and --far, or --depth-range, say what its ends stand for */
};

/* What flat things say: shares, in [0,1], of triples of texels that say so; all 0 if there are too
 * few. */
struct depth_planes {
    size_t count;
    double planar, radial, linear; /* linear: 1/planar, depth buffers, orthographic */
    double offset_share, offset;   /* depth + offset is planar */
    double power_share, power;     /* depth is planar to that power */
    double logarithm_share;        /* depth is the logarithm of planar, to any base */
};
/* Normalised depth: 0 and 1 are these distances. */
struct depth_range {
    bool is_given;
    double zero, one; /* scene units */
    bool is_radial;   /* from the eye; found, not given */
};

enum normal_encoding { NORMAL_ENCODING_AUTO, NORMAL_ENCODING_SIGNED, NORMAL_ENCODING_UNSIGNED };

/* What the image says is wrong of what header and options tell. */
enum told_doubt { DOUBT_NOTHING, DOUBT_CAMERA, DOUBT_TYPE, DOUBT_PIXELS };

/* How depth lies against the normals: rows or columns the other way round. */
enum depth_flip { FLIP_NONE, FLIP_ROWS, FLIP_COLUMNS, FLIP_BOTH };

/* What depth that is background all over is taken for. */
enum empty_depth {
    EMPTY_IS_MISTAKE, /* no picture of anything, unless somebody says what it measures */
    EMPTY_IS_LATE,    /* a frame that waits for one that shows something: err->shows_nothing */
    EMPTY_IS_OPEN     /* a frame of a sequence that shows something: AO is 1, and that is said */
};

/* What is kept of one view of a sequence, from frame to frame. Zero-initialise. */
struct frame_memory {
    /* The camera as it was estimated: AO must not flicker with the estimate. */
    bool is_known;
    struct camera camera; /* its projection */
    enum depth_type depth_type;
    unsigned models; /* as camera_fit takes them: what it was */
    /* That of header or options which was held against the image, and how many normals agreed. */
    struct camera told;
    double told_agreement; /* [0,1] */
    enum told_doubt doubt;
    /* Whether depth is turned against the normals, and how many agreed when that was asked. */
    bool is_flip_asked;
    enum depth_flip flip;
    double flip_agreement; /* [0,1] */
    /* Of the last frame whose depth was not odd. */
    bool has_depth, is_odd_type, is_odd_unit;
    enum depth_type usual_type;
    double usual_z[3]; /* nearest, median and farthest, scene units */
    double background; /* that repeated, in the unit of depth; 0: none */
};

struct gbuffer_options {
    struct role_request roles;
    struct camera_flags camera;
    enum depth_type depth_type;
    struct depth_range depth_range; /* of normalised depth */
    enum background_rule background;
    double background_value; /* in the unit of depth, with BACKGROUND_GIVEN */
    enum empty_depth empty;
    enum normal_space normal_space;
    enum normal_encoding normal_encoding;
    bool is_type_recorded; /* depth_type and depth_range were told, and held, in another run */
    bool want_color;       /* colour is an error if it is missing, and is not read otherwise */
    struct frame_memory *memory; /* of the view, or NULL = a frame of its own */
    struct budget budget;
    /* What the caller will take per texel, counted against the budget: in any case, and more if
     * there are normals. */
    uint64_t work_texel_bytes, work_normals_texel_bytes;
    uint64_t held_bytes; /* what he holds already, likewise */
};

struct gbuffer {
    struct roles roles;
    struct camera camera;
    uint32_t width, height;
    struct exr_box data_window, display_window; /* of the depth part */
    struct exr_box color_window;                /* of color; the data window, unless widened */
    float pixel_aspect;

    float *depth; /* width * height, as view.depth_encoding says; background is background_depth */
    float *normals; /* width * height * 4, xyz in [-1,1]; NULL: from depth */
    float *color;   /* width * height * 4 RGBA; NULL: not wanted */
    /* width * height each; NULL: not named. Lengths, 0 if unknown, or, as depth, where things
     * end. */
    float *thickness;
    float *second_depth; /* as depth */
    double second_min_z; /* the nearest of it, scene units; 0: there is none */
    /* What the composite does with the colour, see light.h; width * height * 4 each, NULL: nothing
     * else. specular: roughness in alpha. */
    float *kept, *albedo, *specular;
    float *holdout; /* width * height, [0,1]: how little AO a texel gets; NULL: all of it */
    float *alpha;   /* of the colour; NULL: there is none, or after gbuffer_load */
    float background_depth;
    bool color_has_alpha; /* else alpha is 1 throughout */

    enum depth_type depth_type; /* of the file, never AUTO */
    enum depth_source depth_source;
    bool has_told_ends;                   /* which say the type */
    struct depth_range depth_range;       /* of normalised depth */
    bool depth_is_half, depth_is_negated; /* as stored; -z, as view space has it */
    struct depth_planes planes;           /* if they were asked */
    struct background background;
    unsigned block_size;  /* of texels that are the same, as enlarging without interpolation does */
    unsigned ridge_width; /* of texels whose nearest or farthest value each has, likewise */
    double noise;         /* widths of a texel that depth bends by where normals do not */
    double filtered_share; /* [0,1] of edges with texels in between, as filters and blur do */
    enum normal_space normal_space; /* AUTO if there are no normals */
    enum normal_encoding normal_encoding;
    bool normals_lack_negative; /* though they are signed */
    enum depth_flip flip;       /* of the depth against the normals, which are left out then */
    /* Of the normals to view space, by the image, whatever header or file say. */
    bool has_seen_rotation;
    double seen_rotation[9]; /* m[row * 3 + column] */
    double seen_weakest[3];  /* in view space: along which normals are fewest */
    bool is_undoubted; /* the camera was held against the image now, which had nothing to say */
    bool is_camera_doubted;  /* the image says another */
    double normal_agreement; /* [0,1] of the normals with those of depth; 0 if that has too few */
    double min_z, median_z, max_z; /* view z of the foreground, scene units; 0 if there is none */
    double background_share;       /* [0,1], with the invalid ones */
    double invalid_share;          /* [0,1] of NaN, -Inf and negative values */
    bool invalid_is_meant;         /* they are what the program writes where there is nothing */
    double depth_step; /* between neighbouring values at the median, scene units; 0 if it is fine */
    struct ao_view view;
};

/* camera_file may be NULL. Errors: EXIT_INPUT, EXIT_CHANNELS, EXIT_MEMORY (also if the budget is
 * too small, which is asked before pixels are read); *gbuffer is then empty but for what was
 * resolved: roles, camera and windows, for `vkao inspect`. */
bool gbuffer_load(const struct exr_info *info, const struct gbuffer_options *options,
                  const struct camera *camera_file, struct report *report, struct gbuffer *gbuffer,
                  struct tool_error *err);
/* The colour in the data window of its own part, which *window becomes; malloc'ed, NULL on
 * error. */
float *gbuffer_read_color(const struct gbuffer *gbuffer, struct exr_box *window,
                          struct tool_error *err);
void gbuffer_free(struct gbuffer *gbuffer);
/* All but the colour, which what is written may need. */
void gbuffer_free_inputs(struct gbuffer *gbuffer);
/* Of a depth that is no background, at a texel of the data window, row * width + column. */
double gbuffer_view_z(const struct gbuffer *gbuffer, float depth, size_t texel);

const char *depth_type_name(enum depth_type type);
const char *normal_space_name(enum normal_space space);
const char *normal_encoding_name(enum normal_encoding encoding);
const char *pixel_type_name(enum exr_pixel_type type);

#endif
