/* SPDX-License-Identifier: MIT
 *
 * Names of channels, layers, parts and views. */
#include "roles_internal.h"

#include "text.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

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

size_t roles_view_count(const struct exr_info *info)
{
    if (info->part_count == 1 && info->parts[0].multi_view_count > 0)
        return info->parts[0].multi_view_count;
    size_t count = 0;
    for (size_t i = 0; i < info->part_count; i++)
        count += first_with_view(info, i);
    return count;
}

const char *roles_view_name(const struct exr_info *info, size_t index)
{
    if (info->part_count == 1 && info->parts[0].multi_view_count > 0)
        return info->parts[0].multi_view[index];
    for (size_t i = 0; i < info->part_count; i++)
        if (first_with_view(info, i) && index-- == 0)
            return info->parts[i].view;
    return "";
}

bool part_has_view(const struct exr_part *part, const char *view)
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
 * OpenEXR leaves out the default one). False if the channel belongs to another view than the wanted
 * one. */
bool channel_name_read(const struct exr_part *part, const char *channel, const char *view,
                       bool multi_part, struct channel_name *name)
{
    const char *dot = strrchr(channel, '.');
    size_t layer = dot ? (size_t)(dot - channel) : 0;
    name->component = dot ? dot + 1 : channel;
    if (part->multi_view_count) {
        size_t start = layer;
        while (start > 0 && channel[start - 1] != '.')
            start--;
        const char *owner = part->multi_view[0];
        size_t owner_length = strlen(owner);
        if (dot && is_view(part, channel + start, layer - start)) {
            owner = channel + start;
            owner_length = layer - start;
            layer = start > 0 ? start - 1 : 0;
        }
        if (*view && (strlen(view) != owner_length || strncmp(owner, view, owner_length) != 0))
            return false;
    }
    name->bare = layer == 0;
    if (name->bare && multi_part)
        part_layer(part, name->layer);
    else
        snprintf(name->layer, sizeof name->layer, "%.*s", (int)layer, channel);
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

/* Whether leaf is one of the alternatives in layers. */
bool layer_fits(const char *layers, const char *leaf)
{
    if (layers[0] == '*')
        return true;
    if (layers[0] == '~')
        return contains_nocase(leaf, layers + 1, strlen(layers + 1));
    if (layers[0] == '=')
        return strcmp(leaf, layers + 1) == 0;
    size_t length = strlen(leaf);
    for (const char *p = layers; length; p++) {
        size_t word = strcspn(p, "|");
        if (word == length && contains_nocase(leaf, p, word))
            return true;
        p += word;
        if (!*p)
            break;
    }
    return false;
}

/* Bare R, G, B of a part called 'N' are normals, not colour; a part called 'beauty' may hold
 * anything. */
bool part_name_forbids(const char *leaf, enum role_kind kind)
{
    for (size_t i = 0; *leaf && i < role_table_count; i++) {
        const struct role_row *row = &role_table[i];
        if (row->layers && row->layers[0] != '*' && row->kind != kind && row->kind != ROLE_COLOR &&
            layer_fits(row->layers, leaf))
            return true;
    }
    return false;
}

bool channel_name_is_never_depth(const struct channel_name *name)
{
    for (size_t i = 0; i < role_never_depth_count; i++) {
        const char *word = role_never_depth[i];
        if (contains_nocase(name->leaf, word, strlen(word)) ||
            text_equal_nocase(name->component, word))
            return true;
    }
    return false;
}
