#version 330 core
// A corner of a face as one point of a pair sees it, in the tile of their visibility disk (thesis 2.6.3).

layout(location = 0) in vec3 position; // x, y at depth 1: -1 .. 1 over the disk's square; depth: 0 at the eye, 1 there
layout(location = 1) in vec2 tile;     // middle of the tile, -1 .. 1 over the atlas

uniform vec2 tile_size; // half of the tile's sides, of the atlas's
uniform vec2 planes;    // depths of the near and the far plane; the disk is at 1

void main() {
  float w = position.z;
  float z = ((planes.y + planes.x) * w - 2.0 * planes.x * planes.y) / (planes.y - planes.x);
  gl_Position = vec4(tile_size * position.xy + tile * w, z, w);
  gl_ClipDistance[0] = w + position.x;
  gl_ClipDistance[1] = w - position.x;
  gl_ClipDistance[2] = w + position.y;
  gl_ClipDistance[3] = w - position.y;
}
