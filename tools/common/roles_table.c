/* SPDX-License-Identifier: MIT
 *
 * Names of channels by renderer, from their sources and manuals. */
#include "roles.h"

/* clang-format off */
const struct role_name role_names[ROLE_KINDS] = {
    [ROLE_DEPTH] = {"depth", "depth", "depth"},
    [ROLE_NORMAL] = {"normal", "normal", "normal"},
    [ROLE_COLOR] = {"color", "color", "color"},
    [ROLE_POSITION] = {"position", "position", "position"},
    [ROLE_AO] = {"AO", "ao", "AO"},
    [ROLE_THICKNESS] = {"thickness", "thickness", "thickness-channel"},
    [ROLE_BACK_DEPTH] = {"back depth", "back_depth", "back-depth"},
    [ROLE_LAYER2] = {"second layer", "layer2", "layer2"},
    [ROLE_ROUGHNESS] = {"roughness", "roughness", "roughness"},
    [ROLE_HOLDOUT] = {"holdout", "holdout", "holdout"},
    [ROLE_NO_CAST] = {"no cast", "no_cast", "no-cast"},
    [ROLE_INDIRECT] = {"indirect", "indirect", "indirect"},
    [ROLE_ALBEDO] = {"albedo", "albedo", "albedo"},
    [ROLE_SPECULAR] = {"specular", "specular", "specular"},
};

#define DEPTH_COMPONENTS {{"Z"}, {"R|red"}, {"depth"}, {"Y"}, {"V"}, {"T"}, {"D"}}
#define VECTOR_COMPONENTS \
    {{"X", "Y", "Z"}, {"R", "G", "B"}, {"red", "green", "blue"}, {"NX", "NY", "NZ"}}
#define NORMAL_LAYERS "N|Ns|Nn|normal|normals"
/* OpenImageIO's own test image has Red, G and B. */
#define COLOR_COMPONENTS \
    {{"R", "G", "B"}, {"red", "green", "blue"}, {"R|red", "G|green", "B|blue"}}

const char *const role_scalar_sets[ROLE_MAX_SETS][ROLE_MAX_COMPONENTS] = DEPTH_COMPONENTS;
const char *const role_vector_sets[ROLE_MAX_SETS][ROLE_MAX_COMPONENTS] = VECTOR_COMPONENTS;
const char *const role_color_sets[ROLE_MAX_SETS][ROLE_MAX_COMPONENTS] = COLOR_COMPONENTS;

const struct role_row role_table[] = {
    /* Blender Depth.Z, Arnold and Redshift Z.Z or depth.Z, Karma depth.Z, V-Ray ZDepth.R, Nuke
     * depth.Z, parts that are named so */
    {.kind = ROLE_DEPTH,
     .layers = "depth|z|linearDepth|cameraDepth|camera_depth|ZDepth|VRayZDepth|CGeometry_ZDepth|"
               "Z-depth|Z depth|Z_depth",
     .sets = DEPTH_COMPONENTS, .is_plain = true},
    /* RenderMan, Arnold, V-Ray, Redshift, OSPRay, old Blender; Karma; Mantra; V-Ray */
    {.kind = ROLE_DEPTH, .sets = {{"Z"}}, .is_plain = true},
    {.kind = ROLE_DEPTH, .sets = {{"depth"}}, .is_plain = true},
    {.kind = ROLE_DEPTH, .sets = {{"Pz"}, {"hitPz"}}},
    {.kind = ROLE_DEPTH, .sets = {{"zDepth"}, {"VRayZDepth"}}, .is_plain = true},
    /* Unreal: FinalImageMovieRenderQueue_WorldDepth.R and relatives */
    {.kind = ROLE_DEPTH, .layers = "~worlddepth", .sets = {{"R"}, {"Z"}}},
    {.kind = ROLE_DEPTH, .layers = "ImageDepth|SceneDepth", .sets = DEPTH_COMPONENTS},
    /* RenderMan's integrator; g is the height above the ground, b how much the surface faces */
    {.kind = ROLE_DEPTH, .layers = "__depth", .sets = {{"R"}}, .is_mixed = true},
    /* Mitsuba: the layer is the user's, the T is Mitsuba's */
    {.kind = ROLE_DEPTH, .layers = "*", .sets = {{"T"}}, .depth_type = DEPTH_RADIAL_NEAR},
    /* Mitsuba 2 had no T: dd.y is what its manual calls the depth */
    {.kind = ROLE_DEPTH, .layers = "dd", .sets = {{"y"}}, .depth_type = DEPTH_RADIAL},
    /* Blender, for its denoiser */
    {.kind = ROLE_DEPTH, .layers = "Denoising Depth", .sets = {{"Z"}}},
    /* Falcor; G is the slope */
    {.kind = ROLE_DEPTH, .layers = "linearZ", .sets = {{"R"}, {"Z"}}, .depth_type = DEPTH_PLANAR,
     .is_mixed = true},
    /* Iray and others; Isaac Sim */
    {.kind = ROLE_DEPTH, .layers = "distance|ray_length|raylength|distance_to_camera",
     .sets = DEPTH_COMPONENTS, .depth_type = DEPTH_RADIAL},
    {.kind = ROLE_DEPTH, .layers = "distance_to_image_plane", .sets = DEPTH_COMPONENTS,
     .depth_type = DEPTH_PLANAR},
    {.kind = ROLE_DEPTH, .sets = {{"distance"}}, .depth_type = DEPTH_RADIAL},
    /* Whatever else calls itself so */
    {.kind = ROLE_DEPTH, .layers = "~depth", .sets = DEPTH_COMPONENTS},
    {.kind = ROLE_DEPTH, .sets = {{"~depth"}}},

    /* pbrt: shading normals in the space of P, that of the camera unless told otherwise; nothing
     * else writes dzdx */
    {.kind = ROLE_NORMAL, .layers = "Ns", .sets = VECTOR_COMPONENTS, .companion = "dzdx",
     .normal_space = NORMAL_SPACE_CAMERA},
    {.kind = ROLE_NORMAL, .layers = "N", .sets = VECTOR_COMPONENTS, .companion = "dzdx",
     .normal_space = NORMAL_SPACE_CAMERA},
    /* V-Ray */
    {.kind = ROLE_NORMAL, .layers = "VRayNormals|bump_normals|bumpNormals|VRayBumpNormals",
     .sets = VECTOR_COMPONENTS, .normal_space = NORMAL_SPACE_CAMERA},
    {.kind = ROLE_NORMAL, .layers = "normals|normal", .sets = VECTOR_COMPONENTS,
     .attribute = "vrayInfo", .normal_space = NORMAL_SPACE_CAMERA},
    /* RenderMan; Mitsuba's manual calls world-space ones nn */
    {.kind = ROLE_NORMAL, .layers = "=Nn", .sets = VECTOR_COMPONENTS,
     .normal_space = NORMAL_SPACE_CAMERA},
    /* Blender Normal, Arnold, Redshift and Karma N, OSPRay normal, Mitsuba by its manual */
    {.kind = ROLE_NORMAL, .layers = "Ns|sh_normal|nn|sn", .sets = VECTOR_COMPONENTS},
    {.kind = ROLE_NORMAL, .layers = "N|hitN", .sets = VECTOR_COMPONENTS},
    {.kind = ROLE_NORMAL, .layers = "normal", .sets = VECTOR_COMPONENTS},
    {.kind = ROLE_NORMAL, .layers = "normals", .sets = VECTOR_COMPONENTS},
    {.kind = ROLE_NORMAL,
     .sets = {{"Nsx", "Nsy", "Nsz"}, {"NX", "NY", "NZ"}, {"N_x", "N_y", "N_z"},
              {"normalX", "normalY", "normalZ"}, {"normal_x", "normal_y", "normal_z"}}},
    {.kind = ROLE_NORMAL,
     .layers = "__Nworld|Nworld|N_world|normal_world|normW|guideNormalW|SHADING_NORMAL|NormalWS|"
               "N_WS|CGeometry_NormalsShading",
     .sets = VECTOR_COMPONENTS, .normal_space = NORMAL_SPACE_WORLD},
    /* Unreal */
    {.kind = ROLE_NORMAL, .layers = "~worldnormal", .sets = VECTOR_COMPONENTS,
     .normal_space = NORMAL_SPACE_WORLD},
    {.kind = ROLE_NORMAL, .layers = "~cameranormal", .sets = VECTOR_COMPONENTS,
     .normal_space = NORMAL_SPACE_CAMERA},
    {.kind = ROLE_NORMAL, .layers = "NormalVS|NormalCS|ViewNormal|N_camera|Ncam|normal_camera",
     .sets = VECTOR_COMPONENTS, .normal_space = NORMAL_SPACE_CAMERA},
    /* 3Delight says the space last; those of the camera need no rotation */
    {.kind = ROLE_NORMAL, .outer = NORMAL_LAYERS, .layers = "camera|cam|view|cameraspace",
     .sets = VECTOR_COMPONENTS, .normal_space = NORMAL_SPACE_CAMERA},
    {.kind = ROLE_NORMAL, .outer = NORMAL_LAYERS, .layers = "world|ws|worldspace",
     .sets = VECTOR_COMPONENTS, .normal_space = NORMAL_SPACE_WORLD},
    {.kind = ROLE_NORMAL, .outer = NORMAL_LAYERS, .layers = "shading|smooth|raw|unfiltered",
     .sets = VECTOR_COMPONENTS},
    {.kind = ROLE_NORMAL, .layers = "nrm|nrml|nml|norm|norms", .sets = VECTOR_COMPONENTS},
    /* Geometric ones show facets, and filtered ones are blurred: better than none */
    {.kind = ROLE_NORMAL, .layers = "gn|Ng|geo_normal|GEOMETRIC_NORMAL|CGeometry_NormalsGeometry",
     .sets = VECTOR_COMPONENTS},
    {.kind = ROLE_NORMAL,
     .layers = "N_denoise|N_denoised|N_filtered|Denoising Normal|OptiXNormals|denoise_normal",
     .sets = VECTOR_COMPONENTS},
    {.kind = ROLE_NORMAL, .outer = NORMAL_LAYERS, .layers = "filtered|denoise|denoised",
     .sets = VECTOR_COMPONENTS},
    /* Octane, Corona and others: Normal (shading), Normal (smooth), Normal (geometric). Nothing is
     * seen in tangent space */
    {.kind = ROLE_NORMAL, .layers = "~normal&shading&!tangent", .sets = VECTOR_COMPONENTS},
    {.kind = ROLE_NORMAL, .layers = "~normal&smooth&!tangent", .sets = VECTOR_COMPONENTS},
    {.kind = ROLE_NORMAL, .layers = "~normal&!geo&!tangent", .sets = VECTOR_COMPONENTS},
    {.kind = ROLE_NORMAL, .layers = "~normal&!tangent", .sets = VECTOR_COMPONENTS},

    {.kind = ROLE_COLOR, .sets = COLOR_COMPONENTS, .place = ROLE_SINGLE_PART},
    {.kind = ROLE_COLOR, .layers = "rgba|rgb|beauty|Combined|C|Ci|RGB_color|color|Composite|Image",
     .sets = COLOR_COMPONENTS},
    {.kind = ROLE_COLOR, .layers = "~_beauty", .sets = COLOR_COMPONENTS},
    {.kind = ROLE_COLOR, .layers = "~FinalImage", .sets = COLOR_COMPONENTS, .attribute = "unreal/"},
    {.kind = ROLE_COLOR, .sets = COLOR_COMPONENTS, .place = ROLE_MULTI_PART},

    {.kind = ROLE_POSITION,
     .layers = "P|Pworld|__Pworld|position|pos|worldPosition|posW|VRayWorldPosition|"
               "CGeometry_WorldPosition|PositionWS|hitP|pointWorld",
     .sets = VECTOR_COMPONENTS},
    /* 3Delight; that of the world tells the rotation of the camera */
    {.kind = ROLE_POSITION, .outer = "P|position|pos", .layers = "world|ws|worldspace",
     .sets = VECTOR_COMPONENTS},
    {.kind = ROLE_POSITION, .outer = "P|position|pos", .layers = "camera|cam|view|cameraspace",
     .sets = VECTOR_COMPONENTS},
    /* Maya */
    {.kind = ROLE_POSITION, .layers = "pointCamera|pointCam", .sets = VECTOR_COMPONENTS},
    /* Unreal, by a material; worldPositions of V-Ray */
    {.kind = ROLE_POSITION, .layers = "~worldpos", .sets = VECTOR_COMPONENTS},

    {.kind = ROLE_AO,
     .layers = "AO|ambient_occlusion|AmbientOcclusion|Ambient Occlusion|VRayExtraTex_AO",
     .sets = {{"R"}, {"Y"}, {"AO"}, {"Z"}}},
    {.kind = ROLE_AO, .sets = {{"AO"}}},
};
/* clang-format on */
const size_t role_table_count = sizeof role_table / sizeof *role_table;

const char *const role_never_depth[] = {"mist", "zback", "crypto", "uv", "motion", "depthoffield"};
const size_t role_never_depth_count = sizeof role_never_depth / sizeof *role_never_depth;
