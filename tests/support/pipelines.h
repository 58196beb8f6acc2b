/* SPDX-License-Identifier: MIT
 *
 * The pipelines of a context, as tests ask for them. */
#ifndef PIPELINES_H_
#define PIPELINES_H_

#include "internal.h"

/* The general pipeline of a stage, without or with bent normals; NULL if the context has none. */
const struct pipeline_entry *general_entry(const vkao_context *ctx, enum pipeline which, bool bent);
/* What a handle that the fake wrote down is of; NULL if it is no pipeline of the context. */
const struct pipeline_entry *entry_of(const vkao_context *ctx, uint64_t pipeline);
/* No variant's. */
bool entry_is_general(const struct pipeline_entry *entry);
uint64_t entry_handle(const struct pipeline_entry *entry);

#endif
