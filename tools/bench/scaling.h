/* SPDX-License-Identifier: MIT
 *
 * How the cost grows: with pixels and with samples it should grow in proportion, with the radius
 * only as far as the caches are left behind. */
#ifndef VKAO_BENCH_SCALING_H_
#define VKAO_BENCH_SCALING_H_

#include "engine.h"
#include "error.h"
#include "text.h"
#include "timings.h"

/* Fills timings with rows of one setting: the series "pixels", "samples" and "radius". sky: as
 * of room_create. */
bool scaling_measure(struct engine *engine, const struct config *config, VkExtent2D extent,
                     unsigned sky, struct timings *timings, struct tool_error *err);
void scaling_report(const struct timings *timings, bool markdown, struct text *text);

#endif
