/* SPDX-License-Identifier: MIT */
#include "ref_composite.h"

void ref_composite(const vkao_composite_params *params, double ao, const double color[4],
                   const double direct[4], double out[4])
{
    double strength = (double)params->strength, a = (1.0 - strength) + ao * strength;
    for (int i = 0; i < 3; ++i) {
        double tint = (double)params->tint[i], factor = tint * (1.0 - a) + a;
        switch (params->mode) {
        case VKAO_COMPOSITE_INDIRECT:
            out[i] = direct[i] + color[i] * factor;
            break;
        case VKAO_COMPOSITE_AO_ONLY:
            out[i] = factor;
            break;
        default:
            out[i] = color[i] * factor;
            break;
        }
    }
    out[3] = params->mode == VKAO_COMPOSITE_AO_ONLY ? 1.0 : color[3];
}
