// SPDX-License-Identifier: MIT
#version 450

// A box (instance 1) on a floor, which is a flat box (instance 0): six faces of two triangles.

layout(push_constant) uniform Push
{
    mat4 projection;
    mat4 world_to_view;
};

layout(location = 0) out vec3 view_normal;

const vec2 corners[] = vec2[](vec2(-1, -1), vec2(1, -1), vec2(1, 1),
                              vec2(-1, -1), vec2(1, 1), vec2(-1, 1));

void main()
{
    bool floor = gl_InstanceIndex == 0;
    vec3 size = floor ? vec3(8.0, 0.1, 8.0) : vec3(0.7, 0.7, 0.7);
    vec3 middle = vec3(0.0, floor ? -size.y : size.y, 0.0);
    int face = gl_VertexIndex / 6, axis = face / 2;
    vec2 corner = corners[gl_VertexIndex % 6];
    vec3 normal = vec3(0.0), position;
    position[axis] = normal[axis] = face % 2 == 0 ? 1.0 : -1.0;
    position[(axis + 1) % 3] = corner.x;
    position[(axis + 2) % 3] = corner.y;
    view_normal = mat3(world_to_view) * normal;
    gl_Position = projection * (world_to_view * vec4(position * size + middle, 1.0));
}
