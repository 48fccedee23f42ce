#version 330 core
// Ambient occlusion from depths [McGuire et al. 2011, the alchemy estimator]: how much of the sky above a point is
// hidden by what lies within `radius`. One value a pixel of the image, whose depth is one of its 2 x 2 samples.

uniform sampler2D depths;
uniform vec2 lens;      // view x, y at depth 1 at the right and upper border of the image
uniform vec2 planes;    // near, far [m]
uniform float radius;   // [m]
uniform vec2 size;      // of the image [pixels]

out vec2 open_and_depth; // open share of the sky, depth [m]

const int n_taps = 12;
const mat2 golden_turn = mat2(-0.73736888, 0.67549029, -0.67549029, -0.73736888);

float view_depth(float d) {
  return planes.x * planes.y / (planes.y - d * (planes.y - planes.x));
}

vec3 view_position(ivec2 pixel) {
  ivec2 inside = clamp(pixel, ivec2(0), ivec2(size) - 1);
  float z = view_depth(texelFetch(depths, 2 * inside, 0).r);
  return vec3(((2.0 * vec2(inside) + 0.5) / size - 1.0) * lens * z, -z);
}

// The nearer neighbour of each pair lies on the same face more often than the farther one.
vec3 towards(vec3 p, vec3 next, vec3 previous) {
  return abs(next.z - p.z) < abs(previous.z - p.z) ? next - p : p - previous;
}

vec3 face_normal(ivec2 pixel, vec3 p) {
  vec3 dx = towards(p, view_position(pixel + ivec2(1, 0)), view_position(pixel - ivec2(1, 0)));
  vec3 dy = towards(p, view_position(pixel + ivec2(0, 1)), view_position(pixel - ivec2(0, 1)));
  return normalize(cross(dx, dy));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  if (texelFetch(depths, 2 * pixel, 0).r == 1.0) {
    open_and_depth = vec2(1.0, planes.y);
    return;
  }
  vec3 p = view_position(pixel);
  vec3 n = face_normal(pixel, p);
  float disk = 0.5 * size.y * radius / (lens.y * -p.z); // [pixels]
  float turn = 6.2831853 * float((pixel.x & 3) + 4 * (pixel.y & 3)) / 16.0;
  vec2 arm = disk * vec2(cos(turn), sin(turn));
  float hidden = 0.0;
  for (int i = 0; i < n_taps; ++i) {
    vec3 d = view_position(pixel + ivec2((float(i) + 0.5) / float(n_taps) * arm)) - p;
    arm = golden_turn * arm;
    float near_enough = max(1.0 - dot(d, d) / (radius * radius), 0.0);
    hidden += near_enough * max(dot(d, n) - 0.03 * radius, 0.0) / (length(d) + 0.02 * radius);
  }
  open_and_depth = vec2(clamp(1.0 - 1.8 * hidden / float(n_taps), 0.0, 1.0), -p.z);
}
