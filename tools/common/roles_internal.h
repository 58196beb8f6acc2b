/* SPDX-License-Identifier: MIT
 *
 * How roles.c reads names. */
#ifndef VKAO_TOOLS_ROLES_INTERNAL_H_
#define VKAO_TOOLS_ROLES_INTERNAL_H_

#include "roles.h"

enum { ROLE_NAME_BYTES = 256 };

/* A channel's name taken apart: layers 'A.B', component 'Z', without its view. */
struct channel_name {
    char layer[ROLE_NAME_BYTES];
    const char *leaf;      /* last component of layer */
    const char *component; /* points into the channel's own name */
    bool bare;             /* no layer in the channel's name: layer is that of the part */
};

/* False if the channel belongs to another view than the wanted one ("" = any). */
bool channel_name_read(const struct exr_part *part, const char *channel, const char *view,
                       bool multi_part, struct channel_name *name);
bool channel_name_is_never_depth(const struct channel_name *name);
/* Whether leaf is one of the alternatives in role_row.layers. */
bool layer_fits(const char *layers, const char *leaf);
/* Bare R, G, B of a part called 'N' are normals, not colour; a part called 'beauty' may hold
 * anything. */
bool part_name_forbids(const char *leaf, enum role_kind kind);
/* Deep parts have no view that could be used. */
bool part_has_view(const struct exr_part *part, const char *view);

#endif
