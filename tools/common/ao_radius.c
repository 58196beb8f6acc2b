/* SPDX-License-Identifier: MIT */
#include "ao_radius.h"

#include "text.h"

#include <math.h>
#include <string.h>

float reference_radius(const struct exr_info *info)
{
    for (size_t p = 0; p < info->part_count; p++) {
        for (size_t i = 0; i < info->parts[p].attribute_count; i++) {
            const struct exr_attribute *a = &info->parts[p].attributes[i];
            double radius = 0;
            if (strcmp(a->name, "aoRadius") != 0)
                continue;
            if (a->number_count == 1)
                radius = a->numbers[0];
            else if (a->text && !text_to_number(a->text, &radius))
                radius = 0;
            if (radius > 0 && isfinite((float)radius))
                return (float)radius;
        }
    }
    return 0;
}
