/* SPDX-License-Identifier: MIT
 *
 * Mattes: what gets no AO, and what casts none. */
#include "cryptomatte.h"
#include "gbuffer_internal.h"
#include "text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* From what share of a texel on it is taken out. */
static const float least_no_cast = 0.5f;

/* --- By objects --- */

/* How much of each texel named objects cover. */
static float *read_objects(const struct exr_info *info, const struct gbuffer *g,
                           const struct gbuffer_options *options, const char *names,
                           struct tool_error *err)
{
    struct cryptomatte matte;
    const size_t texels = gbuffer_texels(g);
    const char *view = options->roles.view ? options->roles.view : "";
    if (!cryptomatte_find(info, view, names, &matte, err))
        return NULL;
    float *covered = gbuffer_allocate(texels, 1, info->path, err);
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
        report_warn(report, option, "%s: --%s '%s' has no number anywhere: it covers nothing",
                    role->info->path, option, role->label);
    else if (below > above && (double)below > least_share * texels)
        report_warn(report, option,
                    "%s: --%s '%s' is negative at %s of the image, want 0 to 1: a component of "
                    "normals or positions?",
                    role->info->path, option, role->label, share);
    else if ((double)above > least_share * texels)
        report_warn(report, option,
                    "%s: --%s '%s' is above 1 at %s of the image, up to %.6g, want 0 to 1: a "
                    "depth, or a matte in other units? What is above 1 counts as 1",
                    role->info->path, option, role->label, share, (double)high);
}

/* --- What it covers --- */

struct coverage {
    size_t surface;
    size_t covered, touched; /* of the surface: as good as all, and at all */
    size_t left;             /* well inside of what is not covered */
};

/* From what share of a texel on a matte counts. */
struct coverage_rule {
    float covered, touched;
};

static bool is_left(const struct gbuffer *g, const float *mask, float covered, size_t texel)
{
    return gbuffer_is_foreground(g, texel) && !(mask[texel] >= covered);
}

static struct coverage look_at_coverage(const struct gbuffer *g, const float *mask,
                                        const struct coverage_rule *rule)
{
    const size_t width = g->width, height = g->height;
    struct coverage c = {0};
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const size_t x = i % width, y = i / width;
        const bool has_all_around = x > 0 && x + 1 < width && y > 0 && y + 1 < height;
        if (!gbuffer_is_foreground(g, i))
            continue;
        c.surface++;
        c.covered += mask[i] >= rule->covered;
        c.touched += mask[i] >= rule->touched;
        c.left += has_all_around && is_left(g, mask, rule->covered, i) &&
                  is_left(g, mask, rule->covered, i - 1) &&
                  is_left(g, mask, rule->covered, i + 1) &&
                  is_left(g, mask, rule->covered, i - width) &&
                  is_left(g, mask, rule->covered, i + width);
    }
    return c;
}

/* Alpha is less than 1 on the outlines of things, a texel or two wide. A matte that is meant leaves
 * things, however small they are in the picture. */
static bool covers_all(const struct coverage *c)
{
    static const double least_covered = 0.9, most_left = 0.001;
    return (double)c->covered >= least_covered * (double)c->surface &&
           (double)c->left <= most_left * (double)c->surface;
}

/* What does not cast is as it says; of a holdout a tenth of the AO is hardly seen, and half a step
 * of 8 bits is nothing. */
static void check_coverage(const struct gbuffer *g, enum role_kind kind, const char *option,
                           const char *path, const float *mask, struct report *report)
{
    static const struct coverage_rule holdout = {0.9f, 0.5f / 255.0f};
    static const struct coverage_rule no_cast = {least_no_cast, least_no_cast};
    const bool is_holdout = kind == ROLE_HOLDOUT;
    const struct role *role = &g->roles.kind[kind];
    const struct coverage c = look_at_coverage(g, mask, is_holdout ? &holdout : &no_cast);
    char share[PERCENT_BYTES];
    if (c.surface == 0)
        return;
    text_percent(share, (double)c.covered / (double)c.surface);
    if (c.touched == 0)
        report_warn(report, option,
                    "%s: --%s '%s' covers nothing of the surface%s: it changes nothing; is it %s?",
                    path, option, role->label, is_holdout ? "" : " by half or more",
                    role->found ? "the right channel" : "in the picture");
    else if (covers_all(&c))
        report_warn(report, option, "%s: --%s '%s' covers %s of the surface, which %s: %s", path,
                    option, role->label, share,
                    is_holdout ? "gets no AO" : "casts nothing and has AO 1",
                    role->found ? "an alpha? Name the matte of the things that are meant"
                                : "name fewer objects");
}

/* A matte by its channel, or by names of objects; *mask is NULL if none was named. */
static bool read_matte(const struct exr_info *info, const struct gbuffer *g,
                       const struct gbuffer_options *options, enum role_kind kind, float **mask,
                       struct report *report, struct tool_error *err)
{
    const struct role *role = &g->roles.kind[kind];
    const size_t prefix = strlen(CRYPTOMATTE_PREFIX);
    const char *option = kind == ROLE_HOLDOUT ? "holdout" : "no-cast";
    if (!role->label[0])
        return true;
    *mask = role->found ? gbuffer_read_role(g, role, 1, 0.0f, err)
                        : read_objects(info, g, options, options->roles.name[kind] + prefix, err);
    if (!*mask)
        return false;
    if (role->found)
        check_matte(g, role, option, options->roles.name[kind], *mask, report);
    check_coverage(g, kind, option, role->found ? role->info->path : info->path, *mask, report);
    return true;
}

bool gbuffer_take_out(const struct exr_info *info, struct gbuffer *g,
                      const struct gbuffer_options *options, struct report *report,
                      struct tool_error *err)
{
    float *mask = NULL;
    if (!read_matte(info, g, options, ROLE_NO_CAST, &mask, report, err))
        return false;
    for (size_t i = 0; mask && i < gbuffer_texels(g); i++)
        if (mask[i] >= least_no_cast)
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
