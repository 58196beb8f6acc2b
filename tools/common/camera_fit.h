/* SPDX-License-Identifier: MIT
 *
 * The camera of an image, estimated from its depth and its normals alone.
 *
 * On a plane, 1/z is linear in the image. So differences of 1/z give the normal of the plane for
 * each field of view that one may assume, and only the true one gives normals that are a rotation
 * of the stored ones: exactly, at any distance and slant. Curved surfaces and bumps follow less
 * well, so flat faces decide. */
#ifndef VKAO_TOOLS_CAMERA_FIT_H_
#define VKAO_TOOLS_CAMERA_FIT_H_

#include "error.h"
#include "exr_file.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What depth may measure, and through which kind of camera. */
enum fit_model {
    FIT_PLANAR,
    FIT_RADIAL,
    FIT_RADIAL_NEAR, /* radial from the near plane, whose distance is estimated too */
    FIT_INVERSE,
    FIT_INVERSE_RADIAL, /* 1 over distances from the eye: nobody writes it but by mistake */
    FIT_ORTHO,
    /* Values in [0,1] whose scale the image does not hold; only to be told from the others. */
    FIT_DEVICE,
    FIT_PLANAR_NORMALIZED,
    FIT_PLANAR_REVERSED,
    FIT_RADIAL_NORMALIZED,
    FIT_ORTHO_REVERSED,
    /* Squeezed towards a largest value a, to a z / (a + z) or a (1 - exp(-z / a)); only to be told
     * from what is not. */
    FIT_TONED,
    FIT_EXPONENTIAL,
    FIT_ORTHO_TONED,
    FIT_ORTHO_EXPONENTIAL,
    FIT_MODELS
};

/* Over how many texels normals are averaged: one; or patches of them, for bump maps. Of patches
 * more normals agree, whatever they are held against. */
enum fit_patch { FIT_PATCH_ANY, FIT_PATCH_NONE, FIT_PATCH_SMALL, FIT_PATCH_LARGE };

struct fit_input {
    const float *depth;   /* width * height, as stored */
    const float *normals; /* width * height * 4, signed, as stored; 0: none */
    uint32_t width, height;
    struct exr_box data_window, display_window;
    double pixel_aspect;
    unsigned models; /* 1 << enum fit_model or-ed: what the depth may be */
    /* What of the camera is known, as struct camera has it; half_width 0: nothing. */
    double half_width, shift_x, shift_y;
    enum fit_patch patch; /* ANY: that which tells most */
    /* Where to look first, and not far from it; 0: everywhere. */
    double near_half_width;
};

struct fit {
    bool is_sure;        /* of model, half_width and shift */
    bool is_usable;      /* or likely to be nearer than a guess */
    bool rotation_known; /* else all normals are parallel, or nearly */
    bool near_known;     /* of FIT_RADIAL and FIT_RADIAL_NEAR */
    bool in_unit_range;  /* depth is */
    enum fit_model model;
    double half_width;       /* at distance 1; FIT_ORTHO: scene units */
    double shift_x, shift_y; /* as struct camera has them */
    double near_plane;       /* of FIT_RADIAL_NEAR and FIT_PLANAR_NORMALIZED, units of depth */
    double seen_near;        /* of FIT_RADIAL too, whether near_known or not; units of depth */
    double near_bound;       /* error of seen_near that is not exceeded; 0: none was seen */
    double rotation[9];      /* of the stored normals to view space, m[row * 3 + column] */
    double weakest[3];       /* in view space: along which normals are fewest */
    double median;           /* of depth as stored */
    double bound;            /* relative error of half_width that is not exceeded, surely not */
    double agreement;        /* [0,1] of the stored normals with those of depth */
    enum fit_patch patch;    /* that agreement is of; never ANY */
    double pixel_aspect;     /* 0, or what is seen if it is not that of the input */
    double squeezed;         /* [0,1] of the stored normals then, if pixel_aspect is not 0 */
    double other_aspect;     /* 0, or what explains as much as the shift does, without one */
    double tone;             /* 0, or the value that depth seems squeezed towards: a */
    enum fit_model curve;    /* of tone */
    double toned;            /* [0,1] agree then, if tone is not 0 */
    bool tells_view;         /* another half_width would be seen in the normals */
    char why[192];           /* not sure: because ... */
};

/* False only if memory runs out; *fit tells all else. */
bool camera_fit(const struct fit_input *input, struct fit *fit, struct tool_error *err);

#endif
