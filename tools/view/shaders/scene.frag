// SPDX-License-Identifier: MIT
#version 450

// Matt surfaces under a sky and a sun. The two lights go into images of their own, because ambient
// occlusion is for the light that comes from everywhere: the sky's.

layout(location = 0) in vec3 world_normal;
layout(location = 1) in vec3 to_eye;
layout(location = 2) in vec3 world_albedo;

layout(location = 0) out vec4 out_normal;
layout(location = 1) out vec4 out_indirect;
layout(location = 2) out vec4 out_direct;
layout(location = 3) out vec4 out_albedo;

const vec3 sky = vec3(0.58, 0.63, 0.70);
const vec3 ground = vec3(0.38, 0.35, 0.32); // what the floor sends back up
const vec3 sun = vec3(0.44, 0.39, 0.32);
const vec3 to_sun = vec3(0.3713907, 0.7427814, 0.5570860); // (2, 4, 3), unit

void main()
{
    vec3 n = normalize(world_normal);
    // At the rim of what is round, interpolated normals turn away from the eye before the triangles
    // do, and vkao would take those of the triangles instead. Bent back they stay smooth; a little
    // further than the rim, because 10 bits round.
    vec3 v = normalize(to_eye);
    n = normalize(n - v * min(dot(n, v) - 0.02, 0.0));
    vec3 ambient = mix(ground, sky, 0.5 + 0.5 * n.y);
    out_normal = vec4(n * 0.5 + 0.5, 1.0);
    out_indirect = vec4(world_albedo * ambient, 1.0);
    out_direct = vec4(world_albedo * sun * max(dot(n, to_sun), 0.0), 1.0);
    out_albedo = vec4(world_albedo, 1.0);
}
