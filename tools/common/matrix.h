/* SPDX-License-Identifier: MIT
 *
 * Matrices of headers. They are for row vectors, as OpenEXR specifies: p' = p m, m[row][column]. */
#ifndef VKAO_TOOLS_MATRIX_H_
#define VKAO_TOOLS_MATRIX_H_

#include <stdbool.h>

struct matrix {
    double m[4][4];
};

struct matrix matrix_transposed(const struct matrix *a);
struct matrix matrix_product(const struct matrix *a, const struct matrix *b);
/* False if there is none. */
bool matrix_inverse(struct matrix a, struct matrix *out);
/* Whether it turns, mirrors and moves, and does nothing else. */
bool matrix_is_rigid(const struct matrix *a);

#endif
