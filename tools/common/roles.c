/* SPDX-License-Identifier: MIT */
#include "roles.h"

#include "cryptomatte.h"
#include "text.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { ROLE_NAME_BYTES = 256 };

/* A channel's name taken apart: layers 'A.B', component 'Z', without its view. */
struct channel_name {
    char layer[ROLE_NAME_BYTES];
    const char *leaf;      /* last component of layer */
    const char *component; /* points into the channel's own name */
    bool bare;             /* no layer in the channel's name: layer is that of the part */
    /* What all channels of the layer begin with: their names, up to the end of the layer. */
    const char *channel;
    size_t prefix;
};

/* --- Views --- */

static bool first_with_view(const struct exr_info *info, size_t part)
{
    const char *view = info->parts[part].view;
    if (!view || !*view)
        return false;
    for (size_t i = 0; i < part; i++)
        if (info->parts[i].view && strcmp(info->parts[i].view, view) == 0)
            return false;
    return true;
}

/* The part whose channels name the views, as in single-part stereo files, to which others may have
 * been appended; NULL if parts are of one view each. */
static const struct exr_part *part_of_all_views(const struct exr_info *info)
{
    for (size_t i = 0; i < info->part_count; i++)
        if (info->parts[i].multi_view_count > 0)
            return &info->parts[i];
    return NULL;
}

size_t roles_view_count(const struct exr_info *info)
{
    if (part_of_all_views(info))
        return part_of_all_views(info)->multi_view_count;
    size_t count = 0;
    for (size_t i = 0; i < info->part_count; i++)
        count += first_with_view(info, i);
    return count;
}

const char *roles_view_name(const struct exr_info *info, size_t index)
{
    if (part_of_all_views(info))
        return part_of_all_views(info)->multi_view[index];
    for (size_t i = 0; i < info->part_count; i++)
        if (first_with_view(info, i) && index-- == 0)
            return info->parts[i].view;
    return "";
}

/* Deep parts have no view that could be used. */
static bool part_has_view(const struct exr_part *part, const char *view)
{
    return !part->deep && (!*view || !part->view || !*part->view || strcmp(part->view, view) == 0);
}

/* --- Names --- */

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

/* In single-part stereo files the last but one component is the view (Blender names all views so,
 * OpenEXR leaves out the default one), or the first (Nuke). False if the channel belongs to another
 * view than the wanted one. */
static bool channel_name_read(const struct exr_part *part, const char *channel, const char *view,
                              bool multi_part, struct channel_name *name)
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

/* Words joined by '&', each of them in the name, or not in it with '!' in front. */
static bool contains_words(const char *name, const char *words)
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

/* Whether name is one of the alternatives, or contains the words behind '~'. */
static bool name_fits(const char *alternatives, const char *name)
{
    if (alternatives[0] == '~')
        return contains_words(name, alternatives + 1);
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
    return name_fits(layers, leaf);
}

/* Bare R, G, B of a part called 'N' are normals, not colour; a part called 'beauty' may hold
 * anything. */
static bool part_name_forbids(const char *leaf, enum role_kind kind)
{
    for (size_t i = 0; *leaf && i < role_table_count; i++) {
        const struct role_row *row = &role_table[i];
        if (row->layers && row->layers[0] != '*' && row->kind != kind && row->kind != ROLE_COLOR &&
            layer_fits(row->layers, leaf))
            return true;
    }
    return false;
}

static bool channel_name_is_never_depth(const struct channel_name *name)
{
    for (size_t i = 0; i < role_never_depth_count; i++) {
        const char *word = role_never_depth[i];
        if (contains_nocase(name->leaf, word, strlen(word)) ||
            text_equal_nocase(name->component, word))
            return true;
    }
    return false;
}

/* --- Searching --- */

enum { MAX_HITS = 16 };

static const char *const option_names[ROLE_KINDS] = {
    "depth",      "normal",  "color",     "position", "AO",      "thickness-channel",
    "back-depth", "layer2",  "roughness", "holdout",  "no-cast", "indirect",
    "albedo",     "specular"};

struct hit {
    size_t part;
    char layer[ROLE_NAME_BYTES];
    size_t set;
    const struct exr_channel *channels[ROLE_MAX_COMPONENTS + 1];
    size_t channel_count;
    bool bare;
};

struct search {
    const struct exr_info *info;
    const char *view; /* "" = any */
    struct hit hits[MAX_HITS];
    size_t count;
};

/* --- Matching --- */

static bool same_layer(const struct channel_name *a, const struct channel_name *b)
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

/* The sibling of a channel with another component; the same case of letters is preferred. */
static const struct exr_channel *sibling(const struct search *s, size_t part_index,
                                         const struct channel_name *name, const char *component)
{
    const struct exr_part *part = &s->info->parts[part_index];
    const struct exr_channel *found = NULL;
    /* Also where the view stands behind the layer. */
    for (size_t i = first_with_prefix(part, name->channel, name->prefix); i < part->channel_count;
         i++) {
        struct channel_name other;
        const char *channel = part->channels[i].name, *dot = strrchr(channel, '.');
        if (strncmp(channel, name->channel, name->prefix) != 0)
            break;
        if (!name_fits(component, dot ? dot + 1 : channel))
            continue;
        if (!channel_name_read(part, channel, s->view, s->info->part_count > 1, &other) ||
            !same_layer(name, &other))
            continue;
        if (!found || strcmp(other.component, component) == 0)
            found = &part->channels[i];
    }
    return found;
}

static bool is_vector(const struct search *s, size_t part, const struct channel_name *name)
{
    return sibling(s, part, name, "X") && sibling(s, part, name, "Y");
}

static bool row_applies(const struct search *s, const struct role_row *row, size_t part_index)
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

static bool row_fits(const struct search *s, const struct role_row *row, size_t part,
                     const struct channel_name *name)
{
    bool layer = row->layers ? layer_fits(row->layers, name->leaf)
                             : name->bare && !part_name_forbids(name->leaf, row->kind);
    if (!layer || row->kind != ROLE_DEPTH)
        return layer;
    return !channel_name_is_never_depth(name) && !is_vector(s, part, name);
}

/* Remembers the hit, or a better spelling of one in the same layer. */
static void add_hit(struct search *s, const struct hit *hit)
{
    for (size_t i = 0; i < s->count; i++) {
        struct hit *old = &s->hits[i];
        if (old->part == hit->part && old->bare == hit->bare &&
            strcmp(old->layer, hit->layer) == 0) {
            if (hit->set < old->set)
                *old = *hit;
            return;
        }
    }
    if (s->count < MAX_HITS)
        s->hits[s->count++] = *hit;
}

/* Adds a hit if the channel is the first component of a set that is there as a whole. */
static void match_sets(struct search *s, const char *const sets[][ROLE_MAX_COMPONENTS], size_t part,
                       const struct exr_channel *channel, const struct channel_name *name)
{
    for (size_t set = 0; set < ROLE_MAX_SETS && sets[set][0]; set++) {
        if (!name_fits(sets[set][0], name->component))
            continue;
        struct hit hit = {.part = part, .set = set, .bare = name->bare};
        /* Several channels of a layer may contain a word: each is a hit of its own. */
        const bool is_word = sets[set][0][0] == '~';
        snprintf(hit.layer, sizeof hit.layer, "%s", is_word ? channel->name : name->layer);
        bool is_whole = true;
        for (size_t c = 0; is_whole && c < ROLE_MAX_COMPONENTS && sets[set][c]; c++) {
            hit.channels[c] = c == 0 ? channel : sibling(s, part, name, sets[set][c]);
            is_whole = hit.channels[c] != NULL;
            hit.channel_count++;
        }
        if (!is_whole)
            continue;
        hit.channels[ROLE_MAX_COMPONENTS] = sibling(s, part, name, "A|alpha");
        add_hit(s, &hit);
    }
}

static void search_row(struct search *s, const struct role_row *row)
{
    s->count = 0;
    for (size_t p = 0; p < s->info->part_count; p++) {
        const struct exr_part *part = &s->info->parts[p];
        if (!part_has_view(part, s->view) || !row_applies(s, row, p))
            continue;
        for (size_t c = 0; c < part->channel_count; c++) {
            struct channel_name name;
            if (channel_name_read(part, part->channels[c].name, s->view, s->info->part_count > 1,
                                  &name) &&
                row_fits(s, row, p, &name))
                match_sets(s, row->sets, p, &part->channels[c], &name);
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
static bool names_layer(const struct search *s, size_t part_index,
                        const struct exr_channel *channel, const struct channel_name *name,
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

static void search_channel(struct search *s, size_t part, const char *wanted)
{
    const struct exr_part *p = &s->info->parts[part];
    for (size_t c = 0; c < p->channel_count; c++) {
        struct channel_name name;
        if (!channel_name_read(p, p->channels[c].name, s->view, s->info->part_count > 1, &name))
            continue;
        char without_view[2 * ROLE_NAME_BYTES];
        snprintf(without_view, sizeof without_view, "%s%s%s", name.bare ? "" : name.layer,
                 name.bare ? "" : ".", name.component);
        if (strcmp(p->channels[c].name, wanted) != 0 && strcmp(without_view, wanted) != 0)
            continue;
        struct hit hit = {.part = part, .channels = {&p->channels[c]}, .channel_count = 1};
        snprintf(hit.layer, sizeof hit.layer, "%s", p->channels[c].name);
        add_hit(s, &hit);
    }
}

static void search_layer(struct search *s, enum role_kind kind, size_t part, const char *wanted)
{
    const struct exr_part *p = &s->info->parts[part];
    for (size_t c = 0; c < p->channel_count; c++) {
        struct channel_name name;
        if (channel_name_read(p, p->channels[c].name, s->view, s->info->part_count > 1, &name) &&
            names_layer(s, part, &p->channels[c], &name, wanted))
            match_sets(s,
                       role_is_scalar(kind) ? role_scalar_sets
                       : kind == ROLE_COLOR ? role_color_sets
                                            : role_vector_sets,
                       part, &p->channels[c], &name);
    }
}

/* A channel of another view, by its whole name. */
static void search_in_full(struct search *s, const char *wanted)
{
    for (size_t p = 0; p < s->info->part_count; p++) {
        const struct exr_part *part = &s->info->parts[p];
        for (size_t c = 0; part->multi_view_count > 0 && c < part->channel_count; c++) {
            if (strcmp(part->channels[c].name, wanted) != 0)
                continue;
            struct hit hit = {.part = p, .channels = {&part->channels[c]}, .channel_count = 1};
            snprintf(hit.layer, sizeof hit.layer, "%s", wanted);
            add_hit(s, &hit);
        }
    }
}

/* name is a channel, a layer, a part or part/one of these. */
static void search_named(struct search *s, enum role_kind kind, const char *name)
{
    s->count = 0;
    for (int layers = 0; layers < 2 && s->count == 0; layers++) {
        if (!layers && !role_is_scalar(kind))
            continue;
        for (size_t i = 0; i < s->info->part_count; i++) {
            const struct exr_part *part = &s->info->parts[i];
            if (!part_has_view(part, s->view))
                continue;
            size_t length = part->name ? strlen(part->name) : 0;
            const char *rest = name;
            if (length && strncmp(name, part->name, length) == 0 && name[length] == '/')
                rest = name + length + 1;
            if (layers)
                search_layer(s, kind, i, rest);
            else
                search_channel(s, i, rest);
        }
    }
}

/* --- Results --- */

static size_t common_prefix(const char *a, const char *b)
{
    size_t n = 0;
    while (a[n] && a[n] == b[n])
        n++;
    return n;
}

/* Two view layers each have normals: those that go with the depth are meant. */
static void prefer_neighbours(struct search *s, const struct role *depth)
{
    if (depth->info != s->info)
        return;
    size_t best = 0, kept = 0;
    const char *near_name = depth->channels[0]->name;
    for (size_t i = 0; i < s->count; i++) {
        size_t n = common_prefix(s->hits[i].channels[0]->name, near_name);
        best = n > best ? n : best;
    }
    for (size_t i = 0; i < s->count; i++)
        if (common_prefix(s->hits[i].channels[0]->name, near_name) == best)
            s->hits[kept++] = s->hits[i];
    s->count = kept;
    kept = 0;
    for (size_t i = 0; i < s->count; i++)
        kept += s->hits[i].part == depth->part;
    if (kept == 1)
        for (size_t i = 0; i < s->count; i++)
            if (s->hits[i].part == depth->part) {
                s->hits[0] = s->hits[i];
                s->count = 1;
            }
}

/* Whether another part of the view has a channel of the same name. */
static bool needs_part_name(const struct search *s, size_t part_index, const char *channel)
{
    for (size_t p = 0; p < s->info->part_count; p++)
        for (size_t c = 0; p != part_index && c < s->info->parts[p].channel_count; c++)
            if (part_has_view(&s->info->parts[p], s->view) &&
                strcmp(s->info->parts[p].channels[c].name, channel) == 0)
                return true;
    return false;
}

static void make_label(const struct search *s, const struct hit *hit, char label[ROLE_LABEL_MAX])
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

/* G beside an R: whether that is a picture in grey shows when it is read. */
static const struct exr_channel *twin_of(const struct search *s, const struct role *role)
{
    const struct exr_part *part = &s->info->parts[role->part];
    struct channel_name name;
    return role->channel_count == 1 &&
                   channel_name_read(part, role->channels[0]->name, s->view,
                                     s->info->part_count > 1, &name) &&
                   name_fits("R|red", name.component)
               ? sibling(s, role->part, &name, "G|green")
               : NULL;
}

static void take_hit(const struct search *s, const struct hit *hit, const struct role_row *row,
                     struct role *role)
{
    role->found = true;
    role->info = s->info;
    role->part = hit->part;
    memcpy(role->channels, hit->channels, sizeof role->channels);
    role->channel_count = hit->channel_count;
    role->depth_type = row ? row->depth_type : DEPTH_AUTO;
    role->normal_space = row ? row->normal_space : NORMAL_SPACE_AUTO;
    role->follows_positions = row && row->companion;
    role->twin = twin_of(s, role);
    make_label(s, hit, role->label);
}

static bool fail_ambiguous(const struct search *s, enum role_kind kind, struct tool_error *err)
{
    struct text list = {0}, arguments = {0};
    for (size_t i = 0; i < s->count; i++) {
        char label[ROLE_LABEL_MAX];
        make_label(s, &s->hits[i], label);
        text_add(&list, "%s'%s'", i ? ", " : "", label);
        text_add(&arguments, "%s--%s '%s'", i ? " or " : "", option_names[kind], label);
    }
    fail_hint(err, "add %s", arguments.data ? arguments.data : "");
    fail(err, EXIT_CHANNELS, "%s: %zu %s candidates: %s", s->info->path, s->count,
         option_names[kind], list.data ? list.data : "");
    text_free(&list);
    text_free(&arguments);
    return false;
}

/* 'R G B A N.X (part "beauty"); Z (part "depth")', as much as fits in a message. */
static void list_channels(const struct exr_info *info, const char *view, struct text *list)
{
    enum { ENOUGH = 600 };
    for (size_t p = 0; p < info->part_count; p++) {
        const struct exr_part *part = &info->parts[p];
        if (*view && part->view && *part->view && strcmp(part->view, view) != 0)
            continue;
        if (list->length)
            text_add(list, ";");
        for (size_t c = 0; c < part->channel_count; c++) {
            if (list->length > ENOUGH) {
                text_add(list, " ... ('vkao inspect' lists all)");
                return;
            }
            text_add(list, "%s%s", list->length ? " " : "", part->channels[c].name);
        }
        if (part->name && *part->name)
            text_add(list, " (part \"%s\")", part->name);
    }
}

/* Depth is often written as a picture of its own. */
static void hint_at_depth(const struct exr_info *info, struct tool_error *err)
{
    const struct exr_part *part = &info->parts[0];
    bool grey = false;
    for (size_t i = 0; i < part->channel_count; i++)
        grey |= strcmp(part->channels[i].name, "R") == 0;
    if (info->part_count == 1 && part->channel_count == 1)
        fail_hint(err, "if this channel is depth, say so: --depth %s", part->channels[0].name);
    else if (info->part_count == 1 && grey)
        fail_hint(err, "say which it is: --depth NAME; --depth R if this is a depth pass written "
                       "as a grey image (R = G = B)");
    else
        fail_hint(err, "say which it is: --depth NAME");
}

static bool fail_missing(const struct exr_info *info, const char *view, enum role_kind kind,
                         const char *name, struct tool_error *err)
{
    struct text list = {0};
    list_channels(info, view, &list);
    const char *channels = list.data ? list.data : "none";
    if (name) {
        fail(err, EXIT_CHANNELS, "%s: no channel or layer '%s'%s%s; channels: %s", info->path, name,
             *view ? " in view " : "", view, channels);
        fail_hint(err,
                  role_is_scalar(kind) ? "--%s takes a channel, a layer or part/channel"
                                       : "--%s takes a layer with three components, X Y Z or R G "
                                         "B, or a part with them",
                  option_names[kind]);
    } else {
        fail(err, EXIT_CHANNELS, "%s: no %s channel found%s%s; channels: %s", info->path,
             option_names[kind], *view ? " in view " : "", view, channels);
        if (kind == ROLE_DEPTH)
            hint_at_depth(info, err);
        else
            fail_hint(err, "say which it is: --%s NAME", option_names[kind]);
    }
    text_free(&list);
    return false;
}

static bool fail_deep(const struct exr_info *info, size_t part, struct tool_error *err)
{
    fail_hint(err, "flatten it first: oiiotool %s --flatten -o flat.exr", info->path);
    return fail(err, EXIT_INPUT, "%s: deep data is not supported (part %zu, %s)", info->path, part,
                info->parts[part].type);
}

/* --- One role --- */

/* --depth P: positions, not one of their components. */
static bool names_positions(struct search *s, const char *name, struct role *role)
{
    for (size_t i = 0; i < role_table_count; i++) {
        if (role_table[i].kind != ROLE_POSITION)
            continue;
        search_row(s, &role_table[i]);
        for (size_t h = 0; h < s->count; h++) {
            char label[ROLE_LABEL_MAX];
            make_label(s, &s->hits[h], label);
            if (strcmp(label, name) != 0)
                continue;
            take_hit(s, &s->hits[h], NULL, role);
            role->depth_type = DEPTH_POSITION;
            return true;
        }
    }
    return false;
}

static bool resolve_named(struct search *s, enum role_kind kind, const char *name,
                          struct role *role, struct tool_error *err)
{
    if (kind == ROLE_DEPTH && names_positions(s, name, role))
        return true;
    search_named(s, kind, name);
    const bool in_view = s->count > 0;
    if (!in_view && role_is_scalar(kind))
        search_in_full(s, name);
    if (s->count == 0)
        return fail_missing(s->info, s->view, kind, name, err);
    if (s->count > 1)
        return fail_ambiguous(s, kind, err);
    /* A row that knows the channel still tells what it measures. */
    const struct hit hit = s->hits[0];
    const struct role_row *known = NULL;
    for (size_t i = 0; i < role_table_count && !known; i++) {
        if (role_table[i].kind != kind)
            continue;
        search_row(s, &role_table[i]);
        for (size_t h = 0; h < s->count; h++)
            if (s->hits[h].channels[0] == hit.channels[0])
                known = &role_table[i];
    }
    take_hit(s, &hit, known, role);
    role->twin = NULL; /* whoever names one channel means it */
    role->of_another_view = !in_view;
    return true;
}

static bool resolve_found(struct search *s, enum role_kind kind, const struct role *depth,
                          struct role *role, struct tool_error *err)
{
    for (size_t i = 0; i < role_table_count; i++) {
        if (role_table[i].kind != kind)
            continue;
        search_row(s, &role_table[i]);
        if (s->count == 0)
            continue;
        if (s->count > 1 && kind != ROLE_DEPTH && depth->found)
            prefer_neighbours(s, depth);
        if (s->count > 1 && (kind == ROLE_DEPTH || kind == ROLE_NORMAL))
            return fail_ambiguous(s, kind, err);
        take_hit(s, &s->hits[0], &role_table[i], role);
        return true;
    }
    return true;
}

/* Where all points are, depth is too. */
static bool take_positions(struct roles *roles)
{
    const struct role *position = &roles->kind[ROLE_POSITION];
    struct role *depth = &roles->kind[ROLE_DEPTH];
    if (!position->found)
        return false;
    *depth = *position;
    depth->depth_type = DEPTH_POSITION;
    return true;
}

static bool is_named_depth(const char *path)
{
    const char *name = strrchr(path, '/');
    name = name ? name + 1 : path;
    return contains_words(name, "depth") && !contains_words(name, "depthoffield") &&
           !contains_words(name, "depth_of_field");
}

/* A picture of its own in a file that is called depth: R of it, if it is grey. */
static bool take_grey_file(struct search *s, struct roles *roles)
{
    static const char *const sets[][ROLE_MAX_COMPONENTS] = {{"R"}, {NULL}};
    struct role *depth = &roles->kind[ROLE_DEPTH], *color = &roles->kind[ROLE_COLOR];
    if (!is_named_depth(s->info->path))
        return false;
    s->count = 0;
    for (size_t p = 0; p < s->info->part_count; p++) {
        const struct exr_part *part = &s->info->parts[p];
        for (size_t c = 0; part_has_view(part, s->view) && c < part->channel_count; c++) {
            struct channel_name name;
            if (channel_name_read(part, part->channels[c].name, s->view, s->info->part_count > 1,
                                  &name) &&
                name.bare)
                match_sets(s, sets, p, &part->channels[c], &name);
        }
    }
    if (s->count != 1)
        return false;
    take_hit(s, &s->hits[0], NULL, depth);
    depth->is_guessed = depth->twin != NULL;
    if (depth->is_guessed && color->channels[0] == depth->channels[0])
        *color = (struct role){0};
    if (!depth->is_guessed)
        *depth = (struct role){0};
    return depth->found;
}

/* In a file of its own a role needs no name: R, G and B of a normal pass are normals. */
static bool resolve_alone(struct search *s, enum role_kind kind, struct role *role,
                          struct tool_error *err)
{
    if (!resolve_found(s, kind, &(struct role){0}, role, err) || role->found)
        return role->found;
    s->count = 0;
    for (size_t p = 0; p < s->info->part_count; p++)
        if (part_has_view(&s->info->parts[p], s->view))
            search_layer(s, kind, p, NULL);
    if (s->count == 0)
        return fail_missing(s->info, s->view, kind, NULL, err);
    if (s->count > 1)
        return fail_ambiguous(s, kind, err);
    take_hit(s, &s->hits[0], NULL, role);
    return true;
}

static bool fail_without_depth(const struct exr_info *info, const char *view,
                               struct tool_error *err)
{
    for (size_t p = 0; p < info->part_count; p++)
        if (info->parts[p].deep)
            return fail_deep(info, p, err);
    return fail_missing(info, view, ROLE_DEPTH, NULL, err);
}

bool roles_resolve(const struct exr_info *info, const struct role_request *request,
                   struct roles *roles, struct tool_error *err)
{
    struct search s = {.info = info, .view = request->view ? request->view : ""};
    struct role *depth = &roles->kind[ROLE_DEPTH];
    bool ok = true;
    *roles = (struct roles){0};
    for (int kind = ROLE_DEPTH; kind < ROLE_KINDS; kind++) {
        struct role *role = &roles->kind[kind];
        const char *name = request->name[kind];
        if (kind == ROLE_NORMAL && request->no_normals)
            continue;
        if (name && (kind == ROLE_HOLDOUT || kind == ROLE_NO_CAST) &&
            text_starts_with(name, CRYPTOMATTE_PREFIX)) {
            snprintf(role->label, sizeof role->label, "%s", name);
            continue; /* names of objects, not of channels */
        }
        const bool is_alone = kind < ROLE_FILES && request->file[kind];
        s.info = is_alone ? request->file[kind] : info;
        ok &= name       ? resolve_named(&s, (enum role_kind)kind, name, role, err)
              : is_alone ? resolve_alone(&s, (enum role_kind)kind, role, err)
                         : resolve_found(&s, (enum role_kind)kind, depth, role, err);
    }
    s.info = info;
    if (ok && !depth->found && !take_positions(roles) && !take_grey_file(&s, roles))
        return fail_without_depth(info, s.view, err);
    return ok;
}

/* --- What was not taken --- */

struct passing {
    struct search search;
    const struct roles *roles;
    role_listener listener;
    void *data;
    const struct exr_channel *told[24];
    size_t count;
};

static bool was_told(const struct passing *p, const struct exr_channel *channel)
{
    for (int kind = ROLE_DEPTH; kind < ROLE_KINDS; kind++)
        for (size_t c = 0; c <= ROLE_MAX_COMPONENTS; c++)
            if (p->roles->kind[kind].channels[c] == channel)
                return true;
    for (size_t i = 0; i < p->count; i++)
        if (p->told[i] == channel)
            return true;
    return false;
}

static void tell(struct passing *p, enum role_kind kind, const struct exr_channel *channel,
                 const char *label, const char *reason)
{
    if (p->count == sizeof p->told / sizeof *p->told || was_told(p, channel))
        return;
    p->told[p->count++] = channel;
    p->listener(p->data, kind, label, reason);
}

/* Those that a row knows, but a better one came before. */
static void tell_later_hits(struct passing *p, enum role_kind kind)
{
    const struct role *taken = &p->roles->kind[kind];
    char reason[ROLE_LABEL_MAX + 32], label[ROLE_LABEL_MAX];
    for (size_t i = 0; i < role_table_count; i++) {
        if (role_table[i].kind != kind)
            continue;
        search_row(&p->search, &role_table[i]);
        for (size_t h = 0; h < p->search.count; h++) {
            make_label(&p->search, &p->search.hits[h], label);
            if (taken->found)
                snprintf(reason, sizeof reason, "'%s' comes first", taken->label);
            else
                snprintf(reason, sizeof reason, "there are several");
            tell(p, kind, p->search.hits[h].channels[0], label, reason);
        }
    }
}

/* Those that look like depth to people. */
static void tell_no_depths(struct passing *p)
{
    const struct search *s = &p->search;
    for (size_t i = 0; i < s->info->part_count; i++) {
        const struct exr_part *part = &s->info->parts[i];
        for (size_t c = 0; c < part->channel_count; c++) {
            struct channel_name name;
            const struct exr_channel *channel = &part->channels[c];
            if (!channel_name_read(part, channel->name, s->view, s->info->part_count > 1, &name) ||
                !(name_fits("Z|depth|distance", name.component) || name_fits("~depth", name.leaf)))
                continue;
            const char *reason = part->deep                           ? "deep data"
                                 : !part_has_view(part, s->view)      ? "of another view"
                                 : channel_name_is_never_depth(&name) ? "no distance by its name"
                                 : is_vector(s, i, &name)             ? "component of a vector"
                                                                      : "no name for depth";
            tell(p, ROLE_DEPTH, channel, channel->name, reason);
        }
    }
}

void roles_passed_over(const struct exr_info *info, const struct role_request *request,
                       const struct roles *roles, role_listener listener, void *data)
{
    struct passing p = {.search = {.info = info, .view = request->view ? request->view : ""},
                        .roles = roles,
                        .listener = listener,
                        .data = data};
    tell_later_hits(&p, ROLE_DEPTH);
    tell_later_hits(&p, ROLE_NORMAL);
    tell_later_hits(&p, ROLE_COLOR);
    tell_no_depths(&p);
}

void roles_list_colors(const struct exr_info *info, const struct role_request *request,
                       struct text *list)
{
    struct search s = {.info = info, .view = request->view ? request->view : ""};
    struct role_row any = {.kind = ROLE_COLOR, .layers = "*"};
    memcpy(any.sets, role_color_sets, sizeof any.sets);
    search_row(&s, &any);
    for (size_t i = 0; i < s.count; i++) {
        char label[ROLE_LABEL_MAX];
        make_label(&s, &s.hits[i], label);
        text_add(list, "%s'%s'", i ? ", " : "", label);
    }
}
