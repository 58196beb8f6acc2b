/* SPDX-License-Identifier: MIT
 *
 * Undo: what the panel changes, as it was. */
#ifndef VKAO_VIEW_HISTORY_H_
#define VKAO_VIEW_HISTORY_H_

#include "setting.h"

#include <stdbool.h>
#include <stddef.h>

enum { HISTORY_STATES = 64, HISTORY_SIDES = 2, HISTORY_SHOWN = 5 };

struct history_state {
    struct setting settings[HISTORY_SIDES];
    double shown[HISTORY_SHOWN]; /* how views show it: whoever keeps them knows their order */
};

struct history {
    struct history_state states[HISTORY_STATES]; /* oldest first */
    size_t count, at;                            /* at: what is now */
};

/* Nothing to undo: this is the first. */
void history_reset(struct history *history, const struct history_state *now);
/* If it has changed, it is a new state, and what was undone is forgotten; of more than
 * HISTORY_STATES the oldest goes. */
void history_note(struct history *history, const struct history_state *now);
/* It is the same state, with what follows from another file changed. */
void history_amend(struct history *history, const struct history_state *now);
/* by: -1 undoes, 1 redoes. False, and *now stays, if there is nothing to. */
bool history_step(struct history *history, int by, struct history_state *now);

#endif
