/* SPDX-License-Identifier: MIT */
#ifndef VKAO_BENCH_FONT_H_
#define VKAO_BENCH_FONT_H_

#include <stdint.h>

/* 5x7 letters, two rows for descenders below. */
enum { FONT_COLUMNS = 5, FONT_ROWS = 9, FONT_BASELINE = 7, FONT_ADVANCE = 6 };

/* FONT_ROWS rows from the top, the leftmost column in bit 4; NULL if there is no such letter. */
const uint8_t *font_glyph(char letter);

#endif
