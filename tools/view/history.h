/* SPDX-License-Identifier: MIT
 *
 * Undo: the settings of both sides as they were. */
#ifndef VKAO_VIEW_HISTORY_H_
#define VKAO_VIEW_HISTORY_H_

#include "setting.h"

#include <stdbool.h>
#include <stddef.h>

enum { HISTORY_STATES = 64, HISTORY_SIDES = 2 };

struct history {
    struct setting states[HISTORY_STATES][HISTORY_SIDES]; /* oldest first */
    size_t count, at;                                     /* at: what the settings are now */
};

/* Nothing to undo: these are the first. */
void history_reset(struct history *history, const struct setting now[HISTORY_SIDES]);
/* If they have changed, they are a new state, and what was undone is forgotten; of more than
 * HISTORY_STATES the oldest goes. */
void history_note(struct history *history, const struct setting now[HISTORY_SIDES]);
/* by: -1 undoes, 1 redoes. False, and settings stay, if there is nothing to. */
bool history_step(struct history *history, int by, struct setting settings[HISTORY_SIDES]);

#endif
