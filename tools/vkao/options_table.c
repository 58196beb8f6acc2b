/* SPDX-License-Identifier: MIT */
#include "options.h"

#include <math.h>

#define AT(member) offsetof(struct options, member)
#define RENDER COMMAND_RENDER
#define INSPECT COMMAND_INSPECT
#define DEVICES COMMAND_DEVICES
#define ABOVE_ZERO                                                                                 \
    {                                                                                              \
        .low = 0, .high = INFINITY, .low_is_excluded = true                                        \
    }
#define FROM_TO(from, to)                                                                          \
    {                                                                                              \
        .low = (from), .high = (to)                                                                \
    }

static const struct option_word modes[] = {
    {"ao", OUTPUT_AO}, {"append", OUTPUT_APPEND}, {"comp", OUTPUT_COMP}, {0}};
static const struct option_word syntaxes[] = {
    {"vfx", FRAME_SYNTAX_VFX}, {"openjd", FRAME_SYNTAX_OPENJD}, {0}};
static const struct option_word pixel_types[] = {{"half", EXR_HALF}, {"float", EXR_FLOAT}, {0}};
static const struct option_word overwrites[] = {{"never", 0}, {"always", 1}, {0}};
static const struct option_word depth_types[] = {{"auto", DEPTH_AUTO},
                                                 {"planar", DEPTH_PLANAR},
                                                 {"radial", DEPTH_RADIAL},
                                                 {"radial-near", DEPTH_RADIAL_NEAR},
                                                 {"inverse", DEPTH_INVERSE},
                                                 {"device", DEPTH_DEVICE},
                                                 {0}};
static const struct option_word spaces[] = {{"auto", NORMAL_SPACE_AUTO},
                                            {"world", NORMAL_SPACE_WORLD},
                                            {"camera", NORMAL_SPACE_CAMERA},
                                            {0}};
static const struct option_word encodings[] = {{"auto", NORMAL_ENCODING_AUTO},
                                               {"signed", NORMAL_ENCODING_SIGNED},
                                               {"unsigned", NORMAL_ENCODING_UNSIGNED},
                                               {0}};
static const struct option_word methods[] = {{"sphere", VKAO_SSAO_SPHERE},
                                             {"hemisphere", VKAO_SSAO_HEMISPHERE},
                                             {"hbao", VKAO_SSAO_HBAO},
                                             {"gtao", VKAO_SSAO_GTAO},
                                             {"vbao", VKAO_SSAO_VBAO},
                                             {"raymarch", VKAO_SSAO_RAYMARCH},
                                             {0}};
static const struct option_word qualities[] = {{"fast", VKAO_QUALITY_FAST},
                                               {"default", VKAO_QUALITY_DEFAULT},
                                               {"high", VKAO_QUALITY_HIGH},
                                               {"best", VKAO_QUALITY_BEST},
                                               {0}};
static const struct option_word forms[] = {
    {"rescaled", VKAO_SPHERE_RESCALED}, {"literal", VKAO_SPHERE_LITERAL}, {0}};
static const struct option_word falloffs[] = {
    {"smooth", VKAO_FALLOFF_SMOOTH}, {"threshold", VKAO_FALLOFF_THRESHOLD}, {0}};

/* clang-format off */
const struct option_row option_table[] = {
    {.heading = "Files", .name = "output", .letter = 'o', .argument = "FILE",
     .help = "EXR file to write; with a frame token if INPUT has one",
     .commands = RENDER, .apply = apply_text, .offset = AT(output)},
    {.name = "mode", .argument = "MODE", .fallback = "ao",
     .help = "ao: a file with channel AO alone; append: all of INPUT, untouched, and a new part "
             "'ao'; comp: colour times AO",
     .commands = RENDER, .apply = apply_word, .offset = AT(mode), .words = modes},
    {.name = "part-name", .argument = "NAME",
     .help = "name of the new part, instead of ao",
     .commands = RENDER, .apply = apply_text, .offset = AT(part_name)},
    {.name = "pixel-type", .argument = "TYPE", .fallback = "half",
     .help = "half or float",
     .commands = RENDER, .apply = apply_word, .offset = AT(pixel_type), .words = pixel_types},
    {.name = "compression", .argument = "NAME", .fallback = "zip",
     .help = "none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa or dwab",
     .commands = RENDER, .apply = apply_compression, .offset = AT(compression)},
    {.name = "preview", .argument = "FILE",
     .help = "write an 8-bit PNG too: AO * 255 without gamma, or the composite in sRGB",
     .commands = RENDER, .apply = apply_text, .offset = AT(preview)},
    {.name = "overwrite", .argument = "WHEN", .fallback = "never",
     .help = "never or always: what to do if an output exists",
     .commands = RENDER, .apply = apply_word, .offset = AT(overwrite), .words = overwrites},
    {.name = "frames", .letter = 'f', .argument = "SPEC",
     .help = "frames of a sequence: 1-100, 1-100x2 (every second), 1,5,20-30. Default: all files"
             " that match INPUT",
     .commands = RENDER, .apply = apply_text, .offset = AT(frames)},
    {.name = "frames-syntax", .argument = "NAME", .fallback = "vfx",
     .help = "vfx, or openjd: 1-100:2 is then a step",
     .commands = RENDER, .apply = apply_word, .offset = AT(frame_syntax), .words = syntaxes},
    {.name = "continue-on-error",
     .help = "go on with the next frame; exit status 1 if any failed",
     .commands = RENDER, .apply = apply_flag, .offset = AT(continue_on_error)},
    {.heading = "Channels", .name = "depth", .argument = "NAME",
     .help = "channel, layer or part/channel. Default: found by the names that renderers use",
     .commands = RENDER | INSPECT, .apply = apply_text,
     .offset = AT(gbuffer.roles.name[ROLE_DEPTH])},
    {.name = "depth-type", .argument = "TYPE", .fallback = "auto",
     .help = "planar: along the view axis; radial: from the eye; radial-near: along the ray from"
             " the near plane (Mitsuba); inverse: 1/planar (Nuke); device: a depth buffer. auto:"
             " planar, but radial-near for channels *.T",
     .commands = RENDER | INSPECT, .apply = apply_word, .offset = AT(gbuffer.depth_type),
     .words = depth_types},
    {.name = "normal", .argument = "NAME",
     .help = "layer of the normals, or none: derive them from depth",
     .commands = RENDER | INSPECT, .apply = apply_normal,
     .offset = AT(gbuffer.roles.name[ROLE_NORMAL])},
    {.name = "normal-space", .argument = "SPACE", .fallback = "auto",
     .help = "world or camera. auto: by name, camera and looks",
     .commands = RENDER | INSPECT, .apply = apply_word, .offset = AT(gbuffer.normal_space),
     .words = spaces},
    {.name = "normal-encoding", .argument = "ENC", .fallback = "auto",
     .help = "signed (-1..1) or unsigned (0..1)",
     .commands = RENDER | INSPECT, .apply = apply_word, .offset = AT(gbuffer.normal_encoding),
     .words = encodings},
    {.name = "color", .argument = "NAME",
     .help = "layer of the colour, for --mode comp",
     .commands = RENDER | INSPECT, .apply = apply_text,
     .offset = AT(gbuffer.roles.name[ROLE_COLOR])},
    {.name = "view", .argument = "NAME",
     .help = "one view of a stereo file, or all. Default: all if the camera file has views",
     .commands = RENDER | INSPECT, .apply = apply_text, .offset = AT(view)},
    {.heading = "Camera", .name = "camera", .argument = "FILE",
     .help = "JSON camera, see vkao(1); may hold a frame token. Default: what the header says",
     .commands = RENDER | INSPECT, .apply = apply_text, .offset = AT(camera_file)},
    {.name = "fov", .argument = "DEG[:h|v]",
     .help = "field of view over the display window, horizontal (h) or vertical",
     .commands = RENDER | INSPECT, .apply = apply_fov, .offset = AT(gbuffer.camera.fov_deg)},
    {.name = "ortho", .argument = "WIDTH",
     .help = "orthographic; scene units over the display window",
     .commands = RENDER | INSPECT, .apply = apply_double, .offset = AT(gbuffer.camera.ortho_width),
     .range = ABOVE_ZERO},
    {.name = "near", .argument = "DISTANCE",
     .help = "near plane, for depth types radial-near and device",
     .commands = RENDER | INSPECT, .apply = apply_double, .offset = AT(gbuffer.camera.near_plane),
     .range = {.low = 0, .high = INFINITY, .low_is_excluded = true, .infinity_is_allowed = true}},
    {.name = "far", .argument = "DISTANCE",
     .help = "far plane, for depth type device; may be inf. near > far: reversed",
     .commands = RENDER | INSPECT, .apply = apply_double, .offset = AT(gbuffer.camera.far_plane),
     .range = {.low = 0, .high = INFINITY, .low_is_excluded = true, .infinity_is_allowed = true}},
    {.heading = "Ambient occlusion",
     .name = "method", .letter = 'm', .argument = "NAME", .fallback = "vbao",
     .help = "vbao, gtao, hbao, hemisphere, sphere or raymarch",
     .commands = RENDER, .apply = apply_word, .offset = AT(ssao.method), .words = methods},
    {.name = "quality", .argument = "NAME", .fallback = "default",
     .help = "fast (half resolution), default, high or best: slices, steps and blur at once",
     .commands = RENDER, .apply = apply_word, .offset = AT(quality), .words = qualities},
    {.name = "slices", .argument = "N",
     .help = "directions per texel of vbao, gtao and hbao, 1 to 64. Default: by --quality",
     .commands = RENDER, .apply = apply_uint, .offset = AT(ssao.slice_count),
     .range = FROM_TO(1, 64)},
    {.name = "steps", .argument = "N",
     .help = "samples on each side of a slice, or on each ray of raymarch, 1 to 256. Default: by "
             "--quality",
     .commands = RENDER, .apply = apply_uint, .offset = AT(ssao.step_count),
     .range = FROM_TO(1, 256)},
    {.name = "thickness", .argument = "X",
     .help = "vbao and raymarch: how thick the scene is behind what is seen, above 0 to 8, relative "
             "to the measured default of 1. Default: by --quality",
     .commands = RENDER, .apply = apply_float, .offset = AT(ssao.thickness),
     .range = {.low = 0, .high = 8, .low_is_excluded = true}},
    {.name = "bent-normals",
     .help = "write the mean open direction too, as channels bent.X, .Y, .Z in the space of the "
             "normals (vbao, gtao, raymarch)",
     .commands = RENDER, .apply = apply_flag, .offset = AT(bent_normals)},
    {.name = "sphere-form", .argument = "FORM", .fallback = "rescaled",
     .help = "rescaled: a flat wall is open; literal: the textbook's, which greys it",
     .commands = RENDER, .apply = apply_word, .offset = AT(ssao.sphere_form), .words = forms},
    {.name = "radius", .letter = 'r', .argument = "R", .fallback = "auto",
     .help = "how far occluders reach, in scene units. auto: 5 % of the median distance of the "
             "first frame",
     .commands = RENDER, .apply = apply_radius, .offset = AT(ssao.radius), .range = ABOVE_ZERO},
    {.name = "falloff", .argument = "NAME", .fallback = "smooth",
     .help = "smooth (weight 1 - (t/R)^2) or threshold",
     .commands = RENDER, .apply = apply_word, .offset = AT(ssao.falloff), .words = falloffs},
    {.name = "samples", .letter = 's', .argument = "N", .fallback = "16",
     .help = "points per texel of hemisphere and sphere, rays of raymarch, 1 to 1024",
     .commands = RENDER, .apply = apply_uint, .offset = AT(ssao.sample_count),
     .range = FROM_TO(1, 1024)},
    {.name = "bias", .argument = "B", .fallback = "0.005",
     .help = "share of the radius, 0 to 1, by which an occluder must stand in front; raised for "
             "half depth if not given",
     .commands = RENDER, .apply = apply_bias, .offset = AT(ssao.bias), .range = FROM_TO(0, 1)},
    {.name = "blocking-scale", .argument = "S", .fallback = "50",
     .help = "constant of --sphere-form literal, 1 / scene units",
     .commands = RENDER, .apply = apply_float, .offset = AT(ssao.blocking_scale),
     .range = ABOVE_ZERO},
    {.name = "noise-index", .argument = "N", .fallback = "0",
     .help = "which noise pattern",
     .commands = RENDER, .apply = apply_uint, .offset = AT(ssao.noise_index),
     .range = FROM_TO(0, 4294967295.0)},
    {.name = "intensity", .letter = 'i', .argument = "X", .fallback = "1",
     .help = "scale of occlusion, 0 to 8; 1 is physical",
     .commands = RENDER, .apply = apply_float, .offset = AT(blur.intensity),
     .range = FROM_TO(0, 8)},
    {.name = "power", .letter = 'p', .argument = "X", .fallback = "1",
     .help = "exponent on visibility, above 0 to 8; 1 is physical",
     .commands = RENDER, .apply = apply_float, .offset = AT(blur.power),
     .range = {.low = 0, .high = 8, .low_is_excluded = true}},
    {.name = "blur", .letter = 'b', .argument = "N", .fallback = "auto",
     .help = "edge-aware blur, 0 to 16 texels on each side; off = 0; auto: by --quality",
     .commands = RENDER, .apply = apply_blur, .offset = AT(blur.radius), .range = FROM_TO(0, 16)},
    {.name = "blur-sharpness", .argument = "X", .fallback = "200",
     .help = "0 (not at all) to 10000: how strictly it stops at edges of depth",
     .commands = RENDER, .apply = apply_float, .offset = AT(blur.sharpness),
     .range = FROM_TO(0, 10000)},
    {.name = "blur-normal-power", .argument = "X", .fallback = "auto",
     .help = "0 to 128: how strictly it stops where normals turn; auto: by --quality",
     .commands = RENDER, .apply = apply_normal_power, .offset = AT(blur.normal_power),
     .range = FROM_TO(0, 128)},
    {.name = "strength", .argument = "X", .fallback = "1",
     .help = "--mode comp: 0 (as if open everywhere) to 1",
     .commands = RENDER, .apply = apply_float, .offset = AT(composite.strength),
     .range = FROM_TO(0, 1)},
    {.name = "tint", .argument = "R,G,B", .fallback = "0,0,0",
     .help = "--mode comp: linear colour of full occlusion",
     .commands = RENDER, .apply = apply_tint, .offset = AT(composite.tint),
     .range = FROM_TO(0, 1)},
    {.heading = "Running", .name = "device", .letter = 'd', .argument = "NAME", .fallback = "auto",
     .help = "auto, cpu, a number from 'vkao devices' or part of a name",
     .commands = RENDER, .apply = apply_text, .offset = AT(device)},
    {.name = "threads", .argument = "N", .fallback = "0",
     .help = "threads that read and write EXR; 0: one for each processor",
     .commands = RENDER | INSPECT, .apply = apply_uint, .offset = AT(threads),
     .range = FROM_TO(0, 256)},
    {.name = "validation",
     .help = "run with the Vulkan validation layers",
     .commands = RENDER, .apply = apply_flag, .offset = AT(validation)},
    {.name = "json",
     .help = "inspect and devices: print JSON",
     .commands = INSPECT | DEVICES, .apply = apply_flag, .offset = AT(json)},
    {.name = "verbose", .letter = 'v',
     .help = "times per frame, and what was found",
     .commands = RENDER | INSPECT | DEVICES, .apply = apply_verbose, .offset = AT(verbosity)},
    {.name = "quiet", .letter = 'q',
     .help = "errors only",
     .commands = RENDER | INSPECT | DEVICES, .apply = apply_quiet, .offset = AT(verbosity)},
    {.name = "version", .letter = 'V',
     .help = "print versions",
     .commands = RENDER | INSPECT | DEVICES, .apply = apply_flag, .offset = AT(version)},
    {.name = "help", .letter = 'h',
     .help = "print this",
     .commands = RENDER | INSPECT | DEVICES, .apply = apply_flag, .offset = AT(help)},
};
/* clang-format on */
const size_t option_table_count = sizeof option_table / sizeof *option_table;
