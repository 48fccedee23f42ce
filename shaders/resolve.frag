#version 330 core
// The mean of 2 x 2 samples, darkened where the sky is hidden, over the background, in sRGB.

uniform sampler2D samples;   // linear colours times coverage, coverage
uniform sampler2D occlusion; // open share of the sky in a pattern of 4 x 4 pixels, depth [m]
uniform float radius;        // of the occlusion [m]
uniform vec2 size;           // of the image [pixels]
uniform vec3 top, bottom;    // of the background, sRGB

out vec4 colour;

vec3 to_linear(vec3 c) {
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));
}

vec3 to_srgb(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}

// Averages the pattern away, over pixels of about the same depth.
float open_share(ivec2 pixel) {
  float z = texelFetch(occlusion, pixel, 0).g;
  float sum = 0.0, weight = 0.0;
  for (int y = -2; y < 2; ++y)
    for (int x = -2; x < 2; ++x) {
      vec2 other = texelFetch(occlusion, clamp(pixel + ivec2(x, y), ivec2(0), ivec2(size) - 1), 0).rg;
      float w = max(1.0 - abs(other.g - z) / (0.25 * radius), 1e-4);
      sum += w * other.r;
      weight += w;
    }
  return sum / weight;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 background = mix(bottom, top, gl_FragCoord.y / size.y);
  vec4 solid = texture(samples, gl_FragCoord.xy / size);
  if (solid.a == 0.0) {
    colour = vec4(background, 1.0);
    return;
  }
  vec3 linear = solid.rgb * open_share(pixel) + (1.0 - solid.a) * to_linear(background);
  colour = vec4(to_srgb(linear), 1.0);
}
