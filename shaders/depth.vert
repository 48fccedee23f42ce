#version 330 core
// Depths alone: seen from the key light, and from the eye before colours are.

layout(location = 0) in vec3 position; // view frame [m]

uniform mat4 view_to_clip;

invariant gl_Position;

void main() {
  gl_Position = view_to_clip * vec4(position, 1.0);
}
