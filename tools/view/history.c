/* SPDX-License-Identifier: MIT */
#include "history.h"

#include <string.h>

static bool equal(const struct setting a[HISTORY_SIDES], const struct setting b[HISTORY_SIDES])
{
    uint32_t count;
    const vkao_parameter *parameters = vkao_parameters(&count);
    for (int s = 0; s < HISTORY_SIDES; s++)
        for (uint32_t i = 0; i < count; i++)
            if (!parameter_equals(&parameters[i], &a[s], &b[s]))
                return false;
    return true;
}

void history_reset(struct history *history, const struct setting now[HISTORY_SIDES])
{
    memcpy(history->states[0], now, sizeof history->states[0]);
    history->count = 1;
    history->at = 0;
}

void history_note(struct history *history, const struct setting now[HISTORY_SIDES])
{
    struct history *h = history;
    if (h->count > 0 && equal(h->states[h->at], now))
        return;
    if (h->count > 0 && h->at + 1 == HISTORY_STATES)
        memmove(h->states[0], h->states[1], sizeof h->states - sizeof h->states[0]);
    else if (h->count > 0)
        h->at++;
    h->count = h->at + 1;
    memcpy(h->states[h->at], now, sizeof h->states[0]);
}

bool history_step(struct history *history, int by, struct setting settings[HISTORY_SIDES])
{
    struct history *h = history;
    if (by < 0 ? h->at == 0 : h->at + 1 >= h->count)
        return false;
    h->at = by < 0 ? h->at - 1 : h->at + 1;
    memcpy(settings, h->states[h->at], sizeof h->states[0]);
    return true;
}
