/* SPDX-License-Identifier: MIT
 *
 * The steps of camera_fit: samples of the image, and models that are held against them.
 *
 * Image plane: x right, y up, in half widths of the display window, principal point (cx, cy);
 * k = half_width. A point at z is z (k (x - cx), k (y - cy), -1). */
#ifndef VKAO_TOOLS_CAMERA_FIT_INTERNAL_H_
#define VKAO_TOOLS_CAMERA_FIT_INTERNAL_H_

#include "camera_fit.h"
#include "vec3.h"

enum {
    FIT_CUBE = 6, /* cells of the direction of normals: a cube map of 6 x 6 a side */
    FIT_CELLS = 6 * FIT_CUBE * FIT_CUBE,
    FIT_TILES_X = 8,
    FIT_TILES_Y = 6,
    FIT_TILES = FIT_TILES_X * FIT_TILES_Y,
    FIT_PARAMETERS = 8 /* rotation vector, and the five below */
};

/* A texel and its neighbours at the baseline: itself, left, right, below, above. */
struct fit_sample {
    double x, y, d[5];
    struct vec3 m; /* the stored normal, normalised */
    double weight;
    bool flat; /* the stored normal does not turn here */
    uint8_t tile, cell;
};

/* The same, so many samples at a time, by columns; what there are fewer at the end is made up. */
enum { FIT_CHUNK = 32 };
struct fit_columns {
    double x[FIT_CHUNK], y[FIT_CHUNK], d[5][FIT_CHUNK];
};

struct fit_residual {
    double e2;     /* the square of the sine between model and stored normal, either way round */
    double cosine; /* below 0: the other way round */
};

struct fit_samples {
    struct fit_sample *list;
    struct fit_columns *columns;
    size_t count;
    /* Scratch, of the solution that was last asked about: its normals, and rows of those with one
     * of FIT_SHAPE parameters changed. */
    struct vec3 *normals;
    struct fit_residual *residuals;
    double step_x, step_y; /* baseline, in the unit of x and y */
    double median;         /* of depth: the unit of c */
    double least, most;    /* of depth */
    double log_slope;      /* ln of the median slope of depth: where orthographic widths lie */
    double total_weight;
};

/* blur: half size of the patch over which normals are averaged, 0 = none, for bump maps. count is
 * 0 if there is not enough to go by. False if memory runs out. */
bool fit_samples_take(const struct fit_input *input, unsigned blur, struct fit_samples *samples);
/* Every so-maniest, so that at most `most` are left; shares nothing with all. */
bool fit_samples_thin(const struct fit_samples *all, size_t most, struct fit_samples *samples);
void fit_samples_free(struct fit_samples *samples);

/* p: ln k, cx, cy, c, ln a. c is the near plane in medians of depth, or an offset of the stored
 * value; a is by how much all is higher than it seems, since pixels are not what the file says. */
enum { FIT_LN_K, FIT_CX, FIT_CY, FIT_C, FIT_LN_A, FIT_SHAPE };
struct fit_solution {
    enum fit_model model;
    struct mat3 rotation;
    double p[FIT_SHAPE];
    bool free[FIT_SHAPE];
    double sigma; /* robust scale, sine of an angle */
    double cost;  /* [0,1], weighted mean of e^2 / (e^2 + sigma^2) */
    double tile_cost[FIT_TILES];
    double inlier_weight;        /* share, [0,1] */
    double deviation[FIT_SHAPE]; /* standard errors of p */
    double rotation_deviation;   /* degrees */
    bool shifted, hand_unknown, near_known;
    double near, near_deviation; /* c of FIT_RADIAL and FIT_RADIAL_NEAR, whether it counts or not */
    double doubt;                /* of ln k: by a shift that is not accepted, and not excluded */
};

/* The best of each model and field of view, the least cost first. */
enum { FIT_MOST_FOUND = 64 };
struct fit_found {
    struct fit_solution list[FIT_MOST_FOUND];
    size_t count;
};

/* Scales at which flat faces alone decide, and at which what is exact for most is held. */
#define FIT_SHARPEST_SIGMA 0.0005
#define FIT_LEAST_SIGMA 0.004

bool fit_model_is_ortho(enum fit_model model);
/* The one of which this has a near plane more, or itself. */
enum fit_model fit_model_without_offset(enum fit_model model);
const char *fit_model_name(enum fit_model model);
/* Unit normals of all samples by the depth alone. */
void fit_find_normals(const struct fit_samples *s, const struct fit_solution *at,
                      struct vec3 *normals);
/* Scene units across one unit of the image plane at all samples. */
void fit_find_scales(const struct fit_samples *s, const struct fit_solution *at, double *scales);
/* ln k may lie between these. */
void fit_model_range(const struct fit_samples *s, enum fit_model model, double *low, double *high);

/* The rotation that turns the stored normals into the model's best, from nothing. */
struct mat3 fit_start_rotation(const struct fit_samples *s, const struct fit_solution *at);
/* From the one that it has, at one robust scale after another. */
struct mat3 fit_improve_rotation(const struct fit_samples *s, const struct fit_solution *at,
                                 const double *sigmas, size_t count);
/* Singular values of the correlation of normals, shares of 1: whether the rotation is fixed by
 * them; and the direction that is fixed least. */
void fit_directions(const struct fit_samples *s, const struct fit_solution *at, double values[3],
                    struct vec3 *weakest);

/* Whether enough normals lie beside the one direction that most have. */
bool fit_has_directions(const struct fit_samples *s, const struct fit_solution *at,
                        struct vec3 *weakest);

double fit_cost(const struct fit_samples *s, const struct fit_solution *at, double sigma);
/* Of all samples, and their normals with them: valid until another solution is asked about. */
const struct fit_residual *fit_find_residuals(const struct fit_samples *s,
                                              const struct fit_solution *at);
/* Enough of what is refined afterwards, and of what is not. */
#define FIT_NEARLY 1e-4
#define FIT_FULLY 1e-6
/* Gauss-Newton at one robust scale, until a step lowers the cost by no more than that share of it;
 * fills cost and p alone. */
void fit_descend(const struct fit_samples *s, struct fit_solution *at, double sigma, double enough);
/* By how much the normals turn with ln k, as a sine, where the rotation and all that is free follow
 * it: 0 if any field of view fits, as faces do that are square to the view. */
double fit_sensitivity(const struct fit_samples *s, const struct fit_solution *at);
/* Descends, and fills everything of the solution. */
void fit_refine(const struct fit_samples *s, struct fit_solution *at, double sigma);
struct fit_solution fit_refined(const struct fit_samples *s, const struct fit_solution *from,
                                double sigma);
/* How surely one is better than the other, from their costs by tiles: in standard errors. */
double fit_paired_z(const struct fit_solution *better, const struct fit_solution *worse);

/* Fills bound, why, weakest, rotation_known, is_sure and is_usable, of the best of what was found
 * at one scale. False if memory runs out. */
bool fit_judge(const struct fit_samples *s, const struct fit_found *f, double sigma,
               const struct fit_solution *best, struct fit *fit);
/* The field of view is no surer than that, which may leave the whole unsure. */
void fit_doubt(struct fit *fit, double bound);
/* Share of the weight within 10 degrees. */
double fit_near_share(const struct fit_samples *s, const struct fit_solution *at);
/* Whether another field of view would turn the normals by more than any are true. */
bool fit_tells_view(const struct fit_samples *s, const struct fit_solution *at);

/* Bumps and smooth shading turn normals by as much, as a sine: half of one agrees. */
#define FIT_HALF_AGREEMENT 0.12

struct fit_stretch {
    double times; /* all is higher than it seems: if that is clear, or explains as much as the lens
                   * shift of the best does; else 1 */
    double cost;  /* if it is clear, with a scale of 0.02 or more; else INFINITY */
    double agreement; /* [0,1] of normals, if it is clear; else 0 */
};

/* False if memory runs out. */
bool fit_find_stretch(const struct fit_samples *all, const struct fit_solution *best,
                      struct fit_stretch *stretch);
/* If it is clear; else as of a stretch. */
struct fit_tone {
    double share; /* median of depth over the value that depth nears far away; 0: no tone */
    enum fit_model curve;
    double cost, agreement;
};

/* False if memory runs out. */
bool fit_find_tone(const struct fit_samples *all, const struct fit_solution *best,
                   struct fit_tone *tone);

#endif
