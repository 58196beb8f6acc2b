/* SPDX-License-Identifier: MIT
 *
 * Objects by their names: Cryptomatte stores for each texel pairs of a hashed name and how much of
 * the texel it covers, largest first (Friedman and Jones 2015; specification 1.2). */
#ifndef VKAO_TOOLS_CRYPTOMATTE_H_
#define VKAO_TOOLS_CRYPTOMATTE_H_

#include "exr_file.h"

/* What --holdout and --no-cast take, with names behind it: 'crypto:ball,floor'. */
#define CRYPTOMATTE_PREFIX "crypto:"

enum { CRYPTOMATTE_MAX_RANKS = 48, CRYPTOMATTE_MAX_NAMES = 64 };

struct cryptomatte_rank {
    size_t part;
    const struct exr_channel *id, *coverage;
};

/* The pairs of all layers of a file (objects, materials, assets), and what names become in them. */
struct cryptomatte {
    struct cryptomatte_rank ranks[CRYPTOMATTE_MAX_RANKS];
    size_t rank_count;
    float ids[CRYPTOMATTE_MAX_NAMES];
    size_t id_count;
};

/* names: behind the prefix, separated by commas. view: "" = any. Errors: EXIT_CHANNELS (no
 * Cryptomatte in the file, or one that was rounded to half; a name that its manifest lacks). */
bool cryptomatte_find(const struct exr_info *info, const char *view, const char *names,
                      struct cryptomatte *matte, struct tool_error *err);
/* Whether an identifier is one of the names. */
bool cryptomatte_has(const struct cryptomatte *matte, float id);

#endif
