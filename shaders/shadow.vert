#version 330 core
// Depths seen from the key light.

layout(location = 0) in vec3 position; // view frame [m]

uniform mat4 view_to_light;

void main() {
  gl_Position = view_to_light * vec4(position, 1.0);
}
