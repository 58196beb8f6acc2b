// SPDX-License-Identifier: MIT
#version 450

layout(location = 0) in vec3 view_normal;
layout(location = 0) out vec4 normal;

void main()
{
    normal = vec4(view_normal, 0.0);
}
