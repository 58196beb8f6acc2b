/* SPDX-License-Identifier: MIT */
#include "inspect_print.h"

#include "json_text.h"
#include "roles.h"
#include "text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *text_of(const cJSON *object, const char *key)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, key));
    return text ? text : "";
}

static double number_of(const cJSON *object, const char *key)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    return cJSON_IsNumber(item) ? item->valuedouble : 0;
}

static bool has(const cJSON *object, const char *key)
{
    return cJSON_GetObjectItemCaseSensitive(object, key) != NULL;
}

static void print_box(const cJSON *object, const char *key, const char *label)
{
    int v[4] = {0};
    for (int i = 0; i < 4; i++)
        v[i] = cJSON_GetArrayItem(cJSON_GetObjectItemCaseSensitive(object, key), i)->valueint;
    printf("%s (%d,%d)-(%d,%d)", label, v[0], v[1], v[2], v[3]);
}

static void print_part(const cJSON *part)
{
    printf("part %d", (int)number_of(part, "index"));
    if (*text_of(part, "name"))
        printf(" '%s'", text_of(part, "name"));
    if (*text_of(part, "view"))
        printf(" view %s", text_of(part, "view"));
    printf(": %s %s", text_of(part, "type"), text_of(part, "compression"));
    print_box(part, "data_window", ", data");
    print_box(part, "display_window", ", display");
    if (fabs(number_of(part, "pixel_aspect") - 1.0) > 1e-6)
        printf(", pixel aspect %g", number_of(part, "pixel_aspect"));
    printf("\n");
    const cJSON *channel;
    cJSON_ArrayForEach(channel, cJSON_GetObjectItemCaseSensitive(part, "channels"))
    {
        printf("  %-5s %s", text_of(channel, "type"), text_of(channel, "name"));
        if (number_of(channel, "x_sampling") > 1 || number_of(channel, "y_sampling") > 1)
            printf(" (sub-sampled %gx%g)", number_of(channel, "x_sampling"),
                   number_of(channel, "y_sampling"));
        printf("\n");
    }
}

static void print_camera(const cJSON *camera)
{
    bool ortho = strcmp(text_of(camera, "type"), "orthographic") == 0;
    if (has(camera, "unsupported")) {
        printf("  camera    not supported: %s\n", text_of(camera, "unsupported"));
        return;
    }
    printf("  camera    %s, ", text_of(camera, "type"));
    if (ortho)
        printf("width %.6g", number_of(camera, "ortho_width"));
    else
        printf("%.4g degrees horizontal", number_of(camera, "fov_x_deg"));
    printf(" (%s)", text_of(camera, "source"));
    if (fabs(number_of(camera, "shift_x")) + fabs(number_of(camera, "shift_y")) > 0)
        printf(", shift %g %g", number_of(camera, "shift_x"), number_of(camera, "shift_y"));
    if (has(camera, "near"))
        printf(", near %g", number_of(camera, "near"));
    if (has(camera, "far"))
        printf(", far %g", number_of(camera, "far"));
    printf("; rotation: %s\n", text_of(camera, "rotation"));
    if (has(camera, "remark"))
        printf("            %s\n", text_of(camera, "remark"));
}

static void print_share(const cJSON *object, const char *key, const char *label)
{
    char share[PERCENT_BYTES];
    text_percent(share, number_of(object, key));
    printf("%s%s", label, share);
}

static void print_background(const cJSON *c)
{
    const cJSON *b = cJSON_GetObjectItemCaseSensitive(c, "background");
    print_share(c, "background_share", "; background ");
    if (has(b, "from"))
        printf(" (%.6g and more: %s)", number_of(b, "from"), text_of(b, "why"));
    else if (has(b, "alone"))
        printf(" (%.6g alone: %s)", number_of(b, "value"), text_of(b, "why"));
    else if (has(b, "value"))
        printf(" (%.6g is %s)", number_of(b, "value"), text_of(b, "why"));
}

static void print_conventions(const cJSON *c)
{
    if (!has(c, "min_z"))
        return;
    printf("  depth is  %s (%s): z %.5g to %.5g, median %.5g", text_of(c, "depth_type"),
           text_of(c, "depth_source"), number_of(c, "min_z"), number_of(c, "max_z"),
           number_of(c, "median_z"));
    print_background(c);
    if (number_of(c, "invalid_share") > 0)
        print_share(c, "invalid_share", ", invalid ");
    printf("\n");
    if (!has(c, "normal_encoding")) {
        const cJSON *list = cJSON_GetObjectItemCaseSensitive(c, "unconfirmed"), *item;
        const char *before = "; nothing in the file can confirm ";
        printf("  normals   from depth");
        cJSON_ArrayForEach(item, list)
        {
            printf("%s%s", before, item->valuestring);
            before = " and ";
        }
        printf("\n");
        return;
    }
    printf("  normals   %s space, %s", text_of(c, "normal_space"), text_of(c, "normal_encoding"));
    if (number_of(c, "normal_agreement") > 0)
        print_share(c, "normal_agreement", "; agreement with depth ");
    printf("\n");
}

static void print_passed_over(const cJSON *view)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(view, "passed_over"))
    {
        printf("  not       %s '%s': %s\n", text_of(item, "role"), text_of(item, "name"),
               text_of(item, "why"));
    }
}

static void print_verdict(const cJSON *view, bool is_unchosen)
{
    const cJSON *v = cJSON_GetObjectItemCaseSensitive(view, "verdict"), *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(view, "warnings"))
    {
        printf("  warning   %s\n", item->valuestring);
    }
    if (cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(v, "can_be_processed")))
        printf("  vkao      can process it, with %s%s%s--radius %g (auto) --bias %.3g\n",
               is_unchosen ? "--view " : "", is_unchosen ? text_of(view, "name") : "",
               is_unchosen ? " " : "", number_of(v, "radius"), number_of(v, "bias"));
}

static void print_problem(const cJSON *object)
{
    if (!has(object, "problem"))
        return;
    printf("  problem   %s\n", text_of(object, "problem"));
    if (*text_of(object, "hint"))
        printf("            %s\n", text_of(object, "hint"));
}

/* is_unchosen: one of several, and a run would not know which. */
static void print_view(const cJSON *view, bool is_unchosen)
{
    if (*text_of(view, "name"))
        printf("view %s\n", text_of(view, "name"));
    const cJSON *roles = cJSON_GetObjectItemCaseSensitive(view, "roles");
    const cJSON *missing = cJSON_GetObjectItemCaseSensitive(view, "missing");
    for (int k = 0; k < ROLE_KINDS; k++) {
        const cJSON *role = cJSON_GetObjectItemCaseSensitive(roles, role_names[k].key);
        if (!role)
            continue;
        if (cJSON_IsObject(role))
            printf("  %-9s %s (%s, part %d)\n", role_names[k].key, text_of(role, "name"),
                   text_of(role, "type"), (int)number_of(role, "part"));
        else
            printf("  %-9s -%s%s\n", role_names[k].key, has(missing, role_names[k].key) ? "  " : "",
                   text_of(missing, role_names[k].key));
    }
    print_passed_over(view);
    if (has(view, "camera"))
        print_camera(cJSON_GetObjectItemCaseSensitive(view, "camera"));
    if (has(view, "conventions"))
        print_conventions(cJSON_GetObjectItemCaseSensitive(view, "conventions"));
    print_verdict(view, is_unchosen);
    print_problem(view);
}

static void print_text(const cJSON *root)
{
    const cJSON *item;
    printf("%s\n", text_of(root, "file"));
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(root, "parts")) print_part(item);
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(root, "views"))
        print_view(item, has(root, "problem"));
    print_problem(root);
}

/* Every string as a terminal may see it. */
static bool make_printable(cJSON *item)
{
    bool ok = true;
    if (cJSON_IsString(item)) {
        struct text text = {0};
        text_add_printable(&text, item->valuestring);
        ok = !text.out_of_memory && cJSON_SetValuestring(item, text.data);
        text_free(&text);
    }
    for (cJSON *child = item->child; ok && child; child = child->next)
        ok = make_printable(child);
    return ok;
}

static bool print_json(const cJSON *root)
{
    char *text = json_text(root, true, json_begin());
    if (!text)
        return false;
    puts(text);
    free(text);
    return true;
}

bool inspect_print(cJSON *root, bool json, struct tool_error *err)
{
    if (!(json ? print_json(root) : make_printable(root)))
        return fail(err, EXIT_MEMORY, "out of memory");
    if (!json)
        print_text(root);
    return true;
}
