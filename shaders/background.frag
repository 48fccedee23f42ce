#version 330 core
// The background alone, in sRGB.

uniform float height;      // of the image [pixels]
uniform vec3 top, bottom;  // sRGB

out vec4 colour;

void main() {
  colour = vec4(mix(bottom, top, gl_FragCoord.y / height), 1.0);
}
