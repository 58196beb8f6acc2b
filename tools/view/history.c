/* SPDX-License-Identifier: MIT */
#include "history.h"

#include <string.h>

static bool equal(const struct history_state *a, const struct history_state *b)
{
    uint32_t count;
    const vkao_parameter *parameters = vkao_parameters(&count);
    for (int s = 0; s < HISTORY_SIDES; s++)
        for (uint32_t i = 0; i < count; i++)
            if (!parameter_equals(&parameters[i], &a->settings[s], &b->settings[s]))
                return false;
    return memcmp(a->shown, b->shown, sizeof a->shown) == 0;
}

void history_reset(struct history *history, const struct history_state *now)
{
    history->states[0] = *now;
    history->count = 1;
    history->at = 0;
}

void history_note(struct history *history, const struct history_state *now)
{
    struct history *h = history;
    if (h->count > 0 && equal(&h->states[h->at], now))
        return;
    if (h->count > 0 && h->at + 1 == HISTORY_STATES)
        memmove(h->states, h->states + 1, sizeof h->states - sizeof *h->states);
    else if (h->count > 0)
        h->at++;
    h->count = h->at + 1;
    h->states[h->at] = *now;
}

void history_amend(struct history *history, const struct history_state *now)
{
    history->states[history->at] = *now;
}

bool history_step(struct history *history, int by, struct history_state *now)
{
    struct history *h = history;
    if (by < 0 ? h->at == 0 : h->at + 1 >= h->count)
        return false;
    h->at = by < 0 ? h->at - 1 : h->at + 1;
    *now = h->states[h->at];
    return true;
}
