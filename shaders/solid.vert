#version 330 core

layout(location = 0) in vec3 position; // view frame [m]
layout(location = 1) in vec3 normal;   // view frame, unit
layout(location = 2) in vec3 colour;   // linear
layout(location = 3) in float metal;   // 0 tissue, 1 steel

uniform mat4 projection;

out vec3 p;
out vec3 shaded_normal;
out vec3 albedo;
flat out float steel;

invariant gl_Position;

void main() {
  p = position;
  shaded_normal = normal;
  albedo = colour;
  steel = metal;
  gl_Position = projection * vec4(position, 1.0);
}
