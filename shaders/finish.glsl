/* SPDX-License-Identifier: MIT
 *
 * The end of the line, whichever stage it falls to: intensity and power, bent normals in the
 * caller's space and encoding. They come after the blur because they are not linear: noise would
 * turn into bias. */
#ifndef VKAO_FINISH_GLSL_
#define VKAO_FINISH_GLSL_

#include "half.glsl"
#include "octahedral.glsl"

layout(binding = VKAO_BINDING_AO_WRITE) uniform writeonly image2D ao_out;
#ifndef VKAO_NO_BENT_NORMALS
layout(binding = VKAO_BINDING_BENT_WRITE) uniform writeonly image2D bent_out;
#endif

vec4 encode_normal(vec3 n, uint encoding)
{
    vec3 e = encoding >= VKAO_GLSL_NORMALS_OCT_SNORM ? vec3(encode_octahedral(n), 0.0) : n;
    bool unorm = encoding == VKAO_GLSL_NORMALS_XYZ_UNORM || encoding == VKAO_GLSL_NORMALS_OCT_UNORM;
    return vec4(unorm ? e * 0.5 + 0.5 : e, 0.0);
}

/* What is seen nothing of, background, is open. */
float final_ao(float visibility, bool background)
{
    float ao = clamp(visibility, 0.0, 1.0);
    if (TONED)
        ao = pow(clamp(1.0 - params.intensity * (1.0 - visibility), 0.0, 1.0), params.power);
    return background ? 1.0 : ao;
}

/* result.w: visibility; result.xyz: mean visible direction in view space, of any length; that of
 * background is zero, as its normal is. */
void finish(ivec2 texel, vec4 result, bool background)
{
    imageStore(ao_out, texel, vec4(ao_texel(final_ao(result.w, background))));
#ifndef VKAO_NO_BENT_NORMALS
    if (BENT_NORMALS) {
        vec3 n = params.normal_x.xyz * result.x + params.normal_y.xyz * result.y +
                 params.normal_z.xyz * result.z;
        float length2 = dot(n, n);
        vec4 zero = encode_normal(vec3(0.0, 0.0, 0.0), BENT_ENCODING);
        vec4 code = encode_normal(n * inversesqrt(max(length2, 1.0e-30)), BENT_ENCODING);
        imageStore(bent_out, texel, background || length2 == 0.0 ? zero : code);
    }
#endif
}

#endif
