// SPDX-License-Identifier: MIT
#version 450

// All of it fits the 128 bytes of push constants that every device has: nothing to ring per frame.
layout(push_constant) uniform Push
{
    mat4 view_projection; // world to clip space
    vec4 model[3];        // rows; a rigid motion, so that normals take the same rotation
    vec4 eye;             // position and 1; in orthographic views the direction to it, and 0
} push;

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 albedo;

layout(location = 0) out vec3 world_normal;
layout(location = 1) out vec3 to_eye;
layout(location = 2) out vec3 world_albedo;

vec3 moved(vec4 p)
{
    return vec3(dot(push.model[0], p), dot(push.model[1], p), dot(push.model[2], p));
}

void main()
{
    vec3 world = moved(vec4(position, 1.0));
    world_normal = moved(vec4(normal, 0.0));
    to_eye = push.eye.xyz - push.eye.w * world;
    world_albedo = albedo;
    gl_Position = push.view_projection * vec4(world, 1.0);
}
