/* SPDX-License-Identifier: MIT
 *
 * Mattes: what gets no AO, and what casts none. */
#include "cryptomatte.h"
#include "gbuffer_internal.h"
#include "text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- By objects --- */

/* How much of each texel named objects cover. */
static float *read_objects(const struct exr_info *info, const struct gbuffer *g,
                           const struct gbuffer_options *options, const char *names,
                           struct report *report, struct tool_error *err)
{
    struct cryptomatte matte;
    const size_t texels = gbuffer_texels(g);
    const char *view = options->roles.view ? options->roles.view : "";
    if (!cryptomatte_find(info, view, names, &matte, err))
        return NULL;
    float *covered = gbuffer_allocate(texels, 1, info->path, err), sum = 0.0f;
    if (covered)
        memset(covered, 0, texels * sizeof *covered);
    for (size_t r = 0; covered && r < matte.rank_count; r++) {
        const struct cryptomatte_rank *rank = &matte.ranks[r];
        const struct role role = {
            .info = info, .part = rank->part, .channels = {rank->id, rank->coverage}};
        float *pairs = gbuffer_read_role(g, &role, 2, 0.0f, err);
        for (size_t i = 0; pairs && i < texels; i++)
            if (cryptomatte_has(&matte, pairs[i * 2]))
                covered[i] += pairs[i * 2 + 1];
        if (!pairs) {
            free(covered);
            covered = NULL;
        }
        free(pairs);
    }
    for (size_t i = 0; covered && i < texels; i++)
        sum += covered[i];
    if (covered && !(sum > 0))
        report_warn(report, "objects", "%s: '%s%s' covers nothing", info->path, CRYPTOMATTE_PREFIX,
                    names);
    return covered;
}

/* --- By a channel --- */

/* What of a layer's components is none of the matte; NULL if it is the only one, or was named. */
static const struct exr_channel *component_beside(const struct role *role, const char *name)
{
    const struct exr_part *part = &role->info->parts[role->part];
    const char *channel = role->channels[0]->name, *dot = strrchr(channel, '.');
    const size_t layer = dot ? (size_t)(dot - channel) + 1 : 0;
    if (text_ends_with(name, channel) || (dot && text_ends_with(name, dot)))
        return NULL;
    for (size_t c = 0; c < part->channel_count; c++) {
        const char *other = part->channels[c].name;
        if (strncmp(other, channel, layer) == 0 && !strchr(other + layer, '.') &&
            &part->channels[c] != role->channels[0])
            return &part->channels[c];
    }
    return NULL;
}

/* Filters swing by a tenth beyond the values on either side of an edge. */
static void check_matte(const struct gbuffer *g, const struct role *role, const char *option,
                        const char *name, const float *mask, struct report *report)
{
    static const float most = 1.2f, least = -0.2f;
    static const double least_share = 0.005;
    const double texels = (double)gbuffer_texels(g);
    size_t numbers = 0, above = 0, below = 0;
    float high = 0;
    char share[PERCENT_BYTES];
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        numbers += isnan(mask[i]) ? 0 : 1;
        above += mask[i] > most;
        below += mask[i] < least;
        high = mask[i] > high ? mask[i] : high;
    }
    text_percent(share, (double)(below > above ? below : above) / texels);
    if (component_beside(role, name))
        report_warn(report, "matte channel",
                    "%s: --%s '%s' is a layer of several channels: '%s' is taken for the matte "
                    "(--%s '%s' names another)",
                    role->info->path, option, name, role->channels[0]->name, option,
                    component_beside(role, name)->name);
    if (numbers == 0)
        report_warn(report, "matte", "%s: --%s '%s' has no number anywhere: it covers nothing",
                    role->info->path, option, role->label);
    else if (below > above && (double)below > least_share * texels)
        report_warn(report, "matte",
                    "%s: --%s '%s' is negative at %s of the image, want 0 to 1: a component of "
                    "normals or positions?",
                    role->info->path, option, role->label, share);
    else if ((double)above > least_share * texels)
        report_warn(report, "matte",
                    "%s: --%s '%s' is above 1 at %s of the image, up to %.6g, want 0 to 1: a "
                    "depth, or a matte in other units? What is above 1 counts as 1",
                    role->info->path, option, role->label, share, (double)high);
}

/* A matte by its channel, or by names of objects; *mask is NULL if none was named. */
static bool read_matte(const struct exr_info *info, const struct gbuffer *g,
                       const struct gbuffer_options *options, enum role_kind kind, float **mask,
                       struct report *report, struct tool_error *err)
{
    const struct role *role = &g->roles.kind[kind];
    const size_t prefix = strlen(CRYPTOMATTE_PREFIX);
    if (!role->label[0])
        return true;
    *mask = role->found
                ? gbuffer_read_role(g, role, 1, 0.0f, err)
                : read_objects(info, g, options, options->roles.name[kind] + prefix, report, err);
    if (*mask && role->found)
        check_matte(g, role, kind == ROLE_HOLDOUT ? "holdout" : "no-cast",
                    options->roles.name[kind], *mask, report);
    return *mask != NULL;
}

bool gbuffer_take_out(const struct exr_info *info, struct gbuffer *g,
                      const struct gbuffer_options *options, struct report *report,
                      struct tool_error *err)
{
    float *mask = NULL;
    if (!read_matte(info, g, options, ROLE_NO_CAST, &mask, report, err))
        return false;
    for (size_t i = 0; mask && i < gbuffer_texels(g); i++)
        if (mask[i] >= 0.5f)
            g->depth[i] = g->background_depth;
    free(mask);
    return true;
}

/* Only numbers in [0,1] are let through. */
bool gbuffer_read_holdout(const struct exr_info *info, struct gbuffer *g,
                          const struct gbuffer_options *options, struct report *report,
                          struct tool_error *err)
{
    if (!read_matte(info, g, options, ROLE_HOLDOUT, &g->holdout, report, err))
        return false;
    for (size_t i = 0; g->holdout && i < gbuffer_texels(g); i++)
        g->holdout[i] = g->holdout[i] > 0.0f ? fminf(g->holdout[i], 1.0f) : 0.0f;
    return true;
}
