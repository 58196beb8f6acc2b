/* SPDX-License-Identifier: MIT */
#include "role_search.h"

#include "text.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* --- Names --- */

bool role_part_has_view(const struct exr_part *part, const char *view)
{
    return !part->deep && (!*view || !part->view || !*part->view || strcmp(part->view, view) == 0);
}
/* Parts of one pass and view are called depth_left or ViewLayer.Depth-left: the layer is what
 * stands before. */
static void part_layer(const struct exr_part *part, char layer[ROLE_NAME_BYTES])
{
    snprintf(layer, ROLE_NAME_BYTES, "%s", part->name ? part->name : "");
    size_t length = strlen(layer), view = part->view ? strlen(part->view) : 0;
    if (view && length > view + 1 && strcmp(layer + length - view, part->view) == 0 &&
        strchr("-_.", layer[length - view - 1]))
        layer[length - view - 1] = '\0';
}

static bool is_view(const struct exr_part *part, const char *word, size_t length)
{
    for (size_t i = 0; i < part->multi_view_count; i++)
        if (strlen(part->multi_view[i]) == length &&
            strncmp(part->multi_view[i], word, length) == 0)
            return true;
    return false;
}

bool role_channel_read(const struct exr_part *part, const char *channel, const char *view,
                       bool multi_part, struct role_channel *name)
{
    const char *dot = strrchr(channel, '.');
    size_t layer = dot ? (size_t)(dot - channel) : 0, begin = 0;
    name->component = dot ? dot + 1 : channel;
    if (part->multi_view_count) {
        size_t start = layer;
        const size_t first = strcspn(channel, ".");
        while (start > 0 && channel[start - 1] != '.')
            start--;
        const char *owner = part->multi_view[0];
        size_t owner_length = strlen(owner);
        if (dot && is_view(part, channel + start, layer - start)) {
            owner = channel + start;
            owner_length = layer - start;
            layer = start > 0 ? start - 1 : 0;
        } else if (dot && first < layer && is_view(part, channel, first)) {
            owner = channel;
            owner_length = first;
            begin = first + 1;
        }
        if (*view && (strlen(view) != owner_length || strncmp(owner, view, owner_length) != 0))
            return false;
    }
    name->bare = layer == 0;
    name->channel = channel;
    name->prefix = layer;
    if (name->bare && multi_part)
        part_layer(part, name->layer);
    else
        snprintf(name->layer, sizeof name->layer, "%.*s", (int)(layer - begin), channel + begin);
    const char *leaf = strrchr(name->layer, '.');
    name->leaf = leaf ? leaf + 1 : name->layer;
    return true;
}

static bool contains_nocase(const char *text, const char *word, size_t length)
{
    for (; *text; text++) {
        size_t i = 0;
        while (i < length && tolower((unsigned char)text[i]) == tolower((unsigned char)word[i]))
            i++;
        if (i == length)
            return true;
    }
    return false;
}

bool role_name_has(const char *name, const char *words)
{
    while (*words) {
        const bool unwanted = *words == '!';
        words += unwanted;
        const size_t length = strcspn(words, "&");
        if (contains_nocase(name, words, length) == unwanted)
            return false;
        words += length;
        words += *words == '&';
    }
    return true;
}

bool role_name_fits(const char *alternatives, const char *name)
{
    if (alternatives[0] == '~')
        return role_name_has(name, alternatives + 1);
    size_t length = strlen(name);
    for (const char *p = alternatives; length; p++) {
        size_t word = strcspn(p, "|");
        if (word == length && contains_nocase(name, p, word))
            return true;
        p += word;
        if (!*p)
            break;
    }
    return false;
}

static bool layer_fits(const char *layers, const char *leaf)
{
    if (layers[0] == '*')
        return true;
    if (layers[0] == '=')
        return strcmp(leaf, layers + 1) == 0;
    return role_name_fits(layers, leaf);
}

/* The component of the layer before its last. */
static bool outer_fits(const char *outer, const char *layer, const char *leaf)
{
    char before[ROLE_NAME_BYTES];
    if (!outer)
        return true;
    if (leaf == layer)
        return false;
    snprintf(before, sizeof before, "%.*s", (int)(leaf - layer - 1), layer);
    const char *dot = strrchr(before, '.');
    return role_name_fits(outer, dot ? dot + 1 : before);
}

/* Bare R, G, B of a part called 'N' are normals, not colour; a part called 'beauty' may hold
 * anything. */
static bool part_name_forbids(const struct role_channel *name, enum role_kind kind)
{
    const char *leaf = name->leaf;
    for (size_t i = 0; *leaf && i < role_table_count; i++) {
        const struct role_row *row = &role_table[i];
        if (row->layers && row->layers[0] != '*' && row->kind != kind && row->kind != ROLE_COLOR &&
            layer_fits(row->layers, leaf) && outer_fits(row->outer, name->layer, leaf))
            return true;
    }
    return false;
}

bool role_channel_is_never_depth(const struct role_channel *name)
{
    for (size_t i = 0; i < role_never_depth_count; i++) {
        const char *word = role_never_depth[i];
        if (contains_nocase(name->leaf, word, strlen(word)) ||
            text_equal_nocase(name->component, word))
            return true;
    }
    return false;
}

/* --- Matching --- */

static bool same_layer(const struct role_channel *a, const struct role_channel *b)
{
    return a->bare == b->bare && strcmp(a->layer, b->layer) == 0;
}

/* The first of the channels that begin with these bytes, which stand together: files may have
 * thousands of channels, and to compare each with each takes minutes then. */
static size_t first_with_prefix(const struct exr_part *part, const char *prefix, size_t length)
{
    size_t low = 0, high = part->channel_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (strncmp(part->channels[middle].name, prefix, length) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

const struct exr_channel *role_channel_sibling(const struct role_search *s, size_t part_index,
                                               const struct role_channel *name,
                                               const char *component)
{
    const struct exr_part *part = &s->info->parts[part_index];
    const struct exr_channel *found = NULL;
    /* Also where the view stands behind the layer. */
    for (size_t i = first_with_prefix(part, name->channel, name->prefix); i < part->channel_count;
         i++) {
        struct role_channel other;
        const char *channel = part->channels[i].name, *dot = strrchr(channel, '.');
        if (strncmp(channel, name->channel, name->prefix) != 0)
            break;
        if (!role_name_fits(component, dot ? dot + 1 : channel))
            continue;
        if (!role_channel_read(part, channel, s->view, s->info->part_count > 1, &other) ||
            !same_layer(name, &other))
            continue;
        if (!found || strcmp(other.component, component) == 0)
            found = &part->channels[i];
    }
    return found;
}

bool role_channel_is_of_vector(const struct role_search *s, size_t part,
                               const struct role_channel *name)
{
    return role_channel_sibling(s, part, name, "X") && role_channel_sibling(s, part, name, "Y");
}

static bool row_applies(const struct role_search *s, const struct role_row *row, size_t part_index)
{
    const struct exr_part *part = &s->info->parts[part_index];
    bool companion = !row->companion, attribute = !row->attribute;
    for (size_t i = 0; i < part->channel_count && !companion; i++)
        companion = strcmp(part->channels[i].name, row->companion) == 0;
    const struct exr_part *first = &s->info->parts[0];
    for (size_t i = 0; i < first->attribute_count && !attribute; i++)
        attribute = text_starts_with(first->attributes[i].name, row->attribute);
    /* What was the only part, to which others were appended, is read as before. */
    bool multi = s->info->part_count > 1 && part->name && *part->name;
    return companion && attribute && !(row->place == ROLE_SINGLE_PART && multi) &&
           !(row->place == ROLE_MULTI_PART && !multi);
}

static bool row_fits(const struct role_search *s, const struct role_row *row, size_t part,
                     const struct role_channel *name)
{
    bool layer = row->layers ? layer_fits(row->layers, name->leaf) &&
                                   outer_fits(row->outer, name->layer, name->leaf)
                             : name->bare && !part_name_forbids(name, row->kind);
    if (!layer || row->kind != ROLE_DEPTH)
        return layer;
    return !role_channel_is_never_depth(name) && !role_channel_is_of_vector(s, part, name);
}

/* Remembers the hit, or a better spelling of one in the same layer. */
static void add_hit(struct role_search *s, const struct role_hit *hit)
{
    for (size_t i = 0; i < s->count; i++) {
        struct role_hit *old = &s->hits[i];
        if (old->part == hit->part && old->bare == hit->bare &&
            strcmp(old->layer, hit->layer) == 0) {
            if (hit->set < old->set)
                *old = *hit;
            return;
        }
    }
    if (s->count < ROLE_MAX_HITS)
        s->hits[s->count++] = *hit;
}

void role_search_sets(struct role_search *s, const char *const sets[][ROLE_MAX_COMPONENTS],
                      size_t part, const struct exr_channel *channel,
                      const struct role_channel *name)
{
    for (size_t set = 0; set < ROLE_MAX_SETS && sets[set][0]; set++) {
        if (!role_name_fits(sets[set][0], name->component))
            continue;
        struct role_hit hit = {.part = part, .set = set, .bare = name->bare};
        /* Several channels of a layer may contain a word: each is a hit of its own. */
        const bool is_word = sets[set][0][0] == '~';
        snprintf(hit.layer, sizeof hit.layer, "%s", is_word ? channel->name : name->layer);
        bool is_whole = true;
        for (size_t c = 0; is_whole && c < ROLE_MAX_COMPONENTS && sets[set][c]; c++) {
            hit.channels[c] = c == 0 ? channel : role_channel_sibling(s, part, name, sets[set][c]);
            is_whole = hit.channels[c] != NULL;
            hit.channel_count++;
        }
        if (!is_whole)
            continue;
        hit.channels[ROLE_MAX_COMPONENTS] = role_channel_sibling(s, part, name, "A|alpha");
        add_hit(s, &hit);
    }
}

void role_search_row(struct role_search *s, const struct role_row *row)
{
    s->count = 0;
    for (size_t p = 0; p < s->info->part_count; p++) {
        const struct exr_part *part = &s->info->parts[p];
        if (!role_part_has_view(part, s->view) || !row_applies(s, row, p))
            continue;
        for (size_t c = 0; c < part->channel_count; c++) {
            struct role_channel name;
            if (role_channel_read(part, part->channels[c].name, s->view, s->info->part_count > 1,
                                  &name) &&
                row_fits(s, row, p, &name))
                role_search_sets(s, row->sets, p, &part->channels[c], &name);
        }
    }
}

/* --- Names given by the user --- */

static bool has_channel(const struct exr_part *part, const char *name)
{
    const size_t i = first_with_prefix(part, name, strlen(name));
    return i < part->channel_count && strcmp(part->channels[i].name, name) == 0;
}

/* A component stands for its layer: --normal N.X means N. wanted: NULL stands for every layer. */
static bool names_layer(const struct role_search *s, size_t part_index,
                        const struct exr_channel *channel, const struct role_channel *name,
                        const char *wanted)
{
    if (!wanted)
        return true;
    const struct exr_part *part = &s->info->parts[part_index];
    size_t length = strlen(wanted);
    const char *dot = strrchr(wanted, '.');
    const size_t layer = dot ? (size_t)(dot - wanted) + 1 : 0;
    if (layer && strncmp(channel->name, wanted, layer) == 0 &&
        !strchr(channel->name + layer, '.') && has_channel(part, wanted))
        return true;
    return strcmp(name->layer, wanted) == 0 ||
           (strncmp(channel->name, wanted, length) == 0 && channel->name[length] == '.' &&
            !strchr(channel->name + length + 1, '.')) ||
           (part->name && *part->name && strcmp(part->name, wanted) == 0);
}

static void search_channel(struct role_search *s, size_t part, const char *wanted)
{
    const struct exr_part *p = &s->info->parts[part];
    for (size_t c = 0; c < p->channel_count; c++) {
        struct role_channel name;
        if (!role_channel_read(p, p->channels[c].name, s->view, s->info->part_count > 1, &name))
            continue;
        char without_view[2 * ROLE_NAME_BYTES];
        snprintf(without_view, sizeof without_view, "%s%s%s", name.bare ? "" : name.layer,
                 name.bare ? "" : ".", name.component);
        if (strcmp(p->channels[c].name, wanted) != 0 && strcmp(without_view, wanted) != 0)
            continue;
        struct role_hit hit = {.part = part, .channels = {&p->channels[c]}, .channel_count = 1};
        snprintf(hit.layer, sizeof hit.layer, "%s", p->channels[c].name);
        add_hit(s, &hit);
    }
}

void role_search_layer(struct role_search *s, enum role_kind kind, size_t part, const char *wanted)
{
    const struct exr_part *p = &s->info->parts[part];
    for (size_t c = 0; c < p->channel_count; c++) {
        struct role_channel name;
        if (role_channel_read(p, p->channels[c].name, s->view, s->info->part_count > 1, &name) &&
            names_layer(s, part, &p->channels[c], &name, wanted))
            role_search_sets(s,
                             role_is_scalar(kind) ? role_scalar_sets
                             : kind == ROLE_COLOR ? role_color_sets
                                                  : role_vector_sets,
                             part, &p->channels[c], &name);
    }
}

void role_search_in_full(struct role_search *s, const char *wanted)
{
    for (size_t p = 0; p < s->info->part_count; p++) {
        const struct exr_part *part = &s->info->parts[p];
        for (size_t c = 0; part->multi_view_count > 0 && c < part->channel_count; c++) {
            if (strcmp(part->channels[c].name, wanted) != 0)
                continue;
            struct role_hit hit = {.part = p, .channels = {&part->channels[c]}, .channel_count = 1};
            snprintf(hit.layer, sizeof hit.layer, "%s", wanted);
            add_hit(s, &hit);
        }
    }
}

void role_search_named(struct role_search *s, enum role_kind kind, const char *name)
{
    s->count = 0;
    for (int layers = 0; layers < 2 && s->count == 0; layers++) {
        if (!layers && !role_is_scalar(kind))
            continue;
        for (size_t i = 0; i < s->info->part_count; i++) {
            const struct exr_part *part = &s->info->parts[i];
            if (!role_part_has_view(part, s->view))
                continue;
            size_t length = part->name ? strlen(part->name) : 0;
            const char *rest = name;
            if (length && strncmp(name, part->name, length) == 0 && name[length] == '/')
                rest = name + length + 1;
            if (layers)
                role_search_layer(s, kind, i, rest);
            else
                search_channel(s, i, rest);
        }
    }
}
void role_search_only(struct role_search *s, const char *name)
{
    s->count = 0;
    for (size_t i = 0; i < s->info->part_count; i++) {
        const struct exr_part *part = &s->info->parts[i];
        const size_t length = part->name ? strlen(part->name) : 0;
        const bool has_part =
            length && strncmp(name, part->name, length) == 0 && name[length] == '/';
        const char *rest = has_part ? name + length + 1 : name;
        struct role_hit hit = {.part = i, .channel_count = 1};
        size_t count = 0;
        for (size_t c = 0; role_part_has_view(part, s->view) && c < part->channel_count; c++) {
            struct role_channel channel;
            if (!role_channel_read(part, part->channels[c].name, s->view, s->info->part_count > 1,
                                   &channel) ||
                !names_layer(s, i, &part->channels[c], &channel, rest))
                continue;
            hit.channels[0] = &part->channels[c];
            count++;
        }
        if (count != 1)
            continue;
        snprintf(hit.layer, sizeof hit.layer, "%s", hit.channels[0]->name);
        add_hit(s, &hit);
    }
}
/* --- Labels --- */

/* Whether another part of the view has a channel of the same name. */
static bool needs_part_name(const struct role_search *s, size_t part_index, const char *channel)
{
    for (size_t p = 0; p < s->info->part_count; p++)
        for (size_t c = 0; p != part_index && c < s->info->parts[p].channel_count; c++)
            if (role_part_has_view(&s->info->parts[p], s->view) &&
                strcmp(s->info->parts[p].channels[c].name, channel) == 0)
                return true;
    return false;
}

void role_hit_label(const struct role_search *s, const struct role_hit *hit,
                    char label[ROLE_LABEL_MAX])
{
    const struct exr_part *part = &s->info->parts[hit->part];
    const char *channel = hit->channels[0]->name;
    bool multi = s->info->part_count > 1 && part->name && *part->name;
    const char *dot = strrchr(channel, '.');
    bool with_part = multi && (!dot || needs_part_name(s, hit->part, channel));
    int length = hit->channel_count == 1 ? (int)strlen(channel) : dot ? (int)(dot - channel) : 0;
    if (length == 0)
        snprintf(label, ROLE_LABEL_MAX, "%s", multi ? part->name : ROLE_NO_LAYER);
    else
        snprintf(label, ROLE_LABEL_MAX, "%s%s%.*s", with_part ? part->name : "",
                 with_part ? "/" : "", length, channel);
}
