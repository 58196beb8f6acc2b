/* SPDX-License-Identifier: MIT
 *
 * What a driver calls itself. */
#ifndef VKAO_BENCH_DRIVER_H_
#define VKAO_BENCH_DRIVER_H_

#include "gpu.h"

struct driver_name {
    char text[VK_MAX_DRIVER_NAME_SIZE + VK_MAX_DRIVER_INFO_SIZE];
};

/* "NVIDIA 570.86.15"; the number alone of a driver that does not say more. */
struct driver_name driver_name(const struct gpu *gpu);

#endif
