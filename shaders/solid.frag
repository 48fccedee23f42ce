#version 330 core
// Light on tissue and steel, in linear colours: sky and ground, a key light with soft shadows, a weak fill light.

in vec3 p;
in vec3 shaded_normal;
in vec3 albedo;
flat in float steel;

uniform mat4 view_to_light;
uniform vec3 key;           // direction to the key light, view frame, unit
uniform vec3 fill;          // direction to the fill light, view frame, unit
uniform vec3 up;            // to the sky, view frame, unit
uniform float blur_radius;  // of the shadow's border, in texture coordinates of the shadow map
uniform sampler2DShadow shadow_map;

out vec4 colour;

const int n_taps = 6;
const mat2 golden_turn = mat2(-0.73736888, 0.67549029, -0.67549029, -0.73736888);

// A disk of taps around q in the plane of the face, so that a slanted face does not shadow itself. The four samples of
// one pixel of the image turn the disk differently: their mean sees 24 taps.
float lit_share(vec3 q, vec3 plane_normal) {
  vec3 n = mat3(view_to_light) * plane_normal;
  vec2 slope = clamp(-n.xy / (abs(n.z) < 1e-6 ? 1e-6 : n.z), -4.0, 4.0);
  ivec2 quarter = ivec2(gl_FragCoord.xy) & 1;
  float turn = 0.6 * float(quarter.x + 2 * quarter.y);
  vec2 arm = blur_radius * vec2(cos(turn), sin(turn));
  float lit = 0.0;
  for (int i = 0; i < n_taps; ++i) {
    vec2 d = sqrt((float(i) + 0.5) / float(n_taps)) * arm;
    arm = golden_turn * arm;
    lit += texture(shadow_map, vec3(q.xy + d, q.z + dot(slope, d) - 0.0015));
  }
  return lit / float(n_taps);
}

float shadow(vec3 plane_normal) {
  vec3 q = 0.5 * (view_to_light * vec4(p, 1.0)).xyz + 0.5;
  return lit_share(q, plane_normal);
}

float gloss(vec3 n, vec3 to_light, vec3 to_eye, float exponent) {
  return pow(max(dot(n, normalize(to_light + to_eye)), 0.0), exponent);
}

vec3 sky_light(vec3 n) {
  return mix(vec3(0.24, 0.21, 0.20), vec3(0.50, 0.51, 0.54), 0.5 + 0.5 * dot(n, up));
}

// Light that entered the tissue elsewhere softens the border between day and night, red the most.
vec3 tissue(vec3 n, vec3 v, float lit) {
  float facing = dot(n, key);
  vec3 scatter = vec3(0.16, 0.05, 0.04);
  vec3 direct = max((facing + scatter) / (1.0 + scatter), 0.0) * lit;
  vec3 light = sky_light(n) + 0.78 * vec3(1.0, 0.97, 0.93) * direct + 0.30 * max(dot(n, fill), 0.0);
  float rim = pow(1.0 - max(dot(n, v), 0.0), 4.0);
  vec3 wet = vec3(lit * (0.05 * gloss(n, key, v, 14.0) + 0.13 * gloss(n, key, v, 70.0)) + 0.05 * rim);
  return albedo * light + wet;
}

// Brushed steel: a blurred mirror of a bright sky and a dark ground.
vec3 metal(vec3 n, vec3 v, float lit) {
  float height = dot(reflect(-v, n), up);
  float mirror = mix(0.50, 1.10, smoothstep(-0.45, 0.55, height));
  float direct = lit * (0.2 * max(dot(n, key), 0.0) + 0.5 * gloss(n, key, v, 40.0)) + 0.35 * gloss(n, fill, v, 6.0);
  return albedo * (0.75 * mirror + direct);
}

void main() {
  vec3 v = normalize(-p);
  vec3 plane_normal = normalize(cross(dFdx(p), dFdy(p))); // always towards the eye
  vec3 n = normalize(shaded_normal);
  n = gl_FrontFacing ? n : -n;
  float lit = dot(n, key) > -0.15 ? shadow(plane_normal) : 0.0; // beyond, no light arrives
  colour = vec4(steel > 0.5 ? metal(n, v, lit) : tissue(n, v, lit), 1.0);
}
