/* SPDX-License-Identifier: MIT
 *
 * Parameters that what is in a G-buffer decides, where nobody else does. */
#ifndef VKAO_TOOLS_AUTOMATIC_H_
#define VKAO_TOOLS_AUTOMATIC_H_

#include "gbuffer.h"
#include "report.h"

/* A radius that depends on what is seen. Zero-initialised it is the automatic one, 5 %. */
struct relative_radius {
    /* (0,inf): rows of the image at the median distance, if in_pixels; else percent of the median
     * distance. 0: 5 %, in two digits. */
    double amount;
    bool in_pixels;
};

/* Scene units, in three digits, so that who reads them can ask for the same. 1 where nothing is
 * seen. */
float relative_radius_of(const struct relative_radius *relative, const struct gbuffer *gbuffer);
/* Warns where no image can show what is within the radius, at the median distance. */
void check_radius(const struct gbuffer *gbuffer, float radius, struct report *report);
/* bias, or what keeps steps of the depth from occluding one another if that is more. */
float automatic_bias(const struct gbuffer *gbuffer, float radius, float bias);
/* The same, with a warning if it is more. */
float settled_bias(const struct gbuffer *gbuffer, float radius, float bias, struct report *report);

#endif
