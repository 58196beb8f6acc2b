/* SPDX-License-Identifier: MIT */
#include "tone.h"

#include "png_file.h"
#include "shaders/display.h"

void tone_color(const struct tone *tone, const float value[3], double reference, double color[3])
{
    const double first = (double)value[0], d = (first - reference) * tone->gain;
    for (int c = 0; c < 3; c++)
        color[c] = 0;
    if (tone->mode == DISPLAY_AO) {
        color[0] = color[1] = color[2] = first;
    } else if (tone->mode == DISPLAY_DEPTH && first > 0) {
        color[0] = color[1] = color[2] = (first - tone->low) / (tone->high - tone->low);
    } else if (tone->mode == DISPLAY_DIFFERENCE) {
        color[0] = d < 0 ? -d : d * 0.15;
        color[1] = d < 0 ? -d * 0.35 : d * 0.6;
        color[2] = d < 0 ? -d * 0.1 : d;
    } else if (tone->mode == DISPLAY_SRGB || tone->mode == DISPLAY_LIT) {
        for (int c = 0; c < 3; c++)
            color[c] = srgb_of((double)value[c] * tone->exposure);
    } else if (tone->mode == DISPLAY_PLAIN) {
        for (int c = 0; c < 3; c++)
            color[c] = (double)value[c];
    }
}
