#version 330 core
// Writes the texels that were open until now: what is written is newly occluded (thesis 2.6.3).

uniform usampler2D closed; // a word for each row of texels of a tile: occluded before, or outside of the disk
uniform int resolution;    // texels a side of a tile

out vec4 newly;

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  uint row = texelFetch(closed, ivec2(p.x / resolution, p.y), 0).r;
  if (((row >> uint(p.x % resolution)) & 1u) != 0u)
    discard;
  newly = vec4(1.0);
}
