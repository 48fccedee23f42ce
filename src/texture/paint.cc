#include "texture/paint.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/parameters.h"
#include "texture/windows.h"

#include <algorithm>
#include <cmath>

namespace kerf::texture {

namespace {

using Painted = image::Raster<Eigen::Array4f>;

constexpr int tile_size = 64;

struct Tile {
  int left, top, width, height;
};

std::vector<Tile> tiles_of(const Patch& patch) {
  std::vector<Tile> tiles;
  for (int top = 0; top < patch.height; top += tile_size)
    for (int left = 0; left < patch.width; left += tile_size)
      tiles.push_back({left, top, std::min(tile_size, patch.width - left), std::min(tile_size, patch.height - top)});
  return tiles;
}

void paint_plain(const Interior& interior, const Patch& patch, const Blending& how, const Tile& tile, Painted& out) {
  for (int r = tile.top; r < tile.top + tile.height; ++r)
    for (int c = tile.left; c < tile.left + tile.width; ++c)
      out(c, r) = interior.colour(patch.point(c, r), how);
}

void paint_detailed(const Interior& interior, const Patch& patch, const Detail& detail, const Blending& how,
                    const int stride, const Tile& tile, Painted& out) {
  const int gutter = window_radius * stride;
  Windows windows(tile.width, tile.height, gutter, stride);
  std::vector<Blend> blends(static_cast<std::size_t>(tile.width) * tile.height);
  for (int r = -gutter; r < tile.height + gutter; ++r)
    for (int c = -gutter; c < tile.width + gutter; ++c) {
      const Blend blend = interior.blend(patch.point(tile.left + c, tile.top + r), how);
      const Eigen::Array4f colour = interior.colour(blend);
      windows.luminance(c, r) = colour[3];
      if (r >= 0 && c >= 0 && r < tile.height && c < tile.width) {
        blends[static_cast<std::size_t>(r) * tile.width + c] = blend;
        out(tile.left + c, tile.top + r) = colour;
      }
    }
  for (int r = 0; r < tile.height; ++r) {
    windows.find(r, {0, tile.width - 1});
    for (int c = 0; c < tile.width; ++c) {
      const Blend& blend = blends[static_cast<std::size_t>(r) * tile.width + c];
      Eigen::Array4f& colour = out(tile.left + c, tile.top + r);
      const float change = detail.luminance(blend, windows.place(c, r)) - (colour[3] - windows.mean(c, r));
      colour = (colour + change).max(0.0f).min(1.0f);
    }
  }
}

/// How many of a patch's pixels a pixel of the exemplars spans.
int stride_of(const Interior& interior, const Patch& patch) {
  const double pixel = std::sqrt(patch.column.norm() * patch.row.norm());
  return std::clamp(static_cast<int>(std::lround(interior.pixel() / pixel)), 1, 8);
}

} // namespace

Painted paint(const Interior& interior, const Patch& patch, const Detail* detail, const Blending& how) {
  Painted out(patch.width, patch.height, Eigen::Array4f::Zero());
  const auto tiles = tiles_of(patch);
  const int stride = stride_of(interior, patch);
  parallel_for(tiles.size(), [&](const std::size_t i) {
    if (detail)
      paint_detailed(interior, patch, *detail, how, stride, tiles[i], out);
    else
      paint_plain(interior, patch, how, tiles[i], out);
  });
  return out;
}

Painted paint(const Interior& interior, const Patch& patch, const Detail* detail) {
  return paint(interior, patch, detail, interior.options().blending);
}

Patch patch_over(const geometry::TriangleMesh& body, const Frame& frame, const double pixel) {
  Vec2 lower = Vec2::Constant(1e300), upper = -lower;
  for (const Segment& segment : slice(body, frame))
    for (const Vec2& p : segment) {
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
  if (!(upper[0] > lower[0]))
    return {};
  const Vec2 size = (upper - lower) / pixel;
  constexpr double most = 16384;
  if (!(size.maxCoeff() <= most))
    throw ParameterError(Complaint{.path = "--pixel",
                                   .value = to_text(pixel),
                                   .rule = "a picture may have 16384 pixels along a side, this one would have " +
                                           to_text(std::ceil(size.maxCoeff())),
                                   .remedy = "Write a larger side of a pixel, in metres"});
  return {frame.origin + lower[0] * frame.x + lower[1] * frame.y, pixel * frame.x, pixel * frame.y,
          static_cast<int>(std::ceil(size[0])) + 1, static_cast<int>(std::ceil(size[1])) + 1};
}

image::Image picture_of(const Interior& interior, const geometry::TriangleMesh& body, const Patch& patch,
                        const Detail* detail, const Blending& how) {
  const double pixel = patch.column.norm();
  std::vector<Segment> curves = slice(body, {patch.origin, patch.column / pixel, patch.row / pixel});
  for (Segment& segment : curves)
    for (Vec2& p : segment)
      p /= pixel;
  return {colours_of(paint(interior, patch, detail, how)), inside_of(curves, patch.width, patch.height)};
}

image::Colours colours_of(const Painted& painted) {
  image::Colours colours(painted.width, painted.height, image::Rgb::Zero());
  for (std::size_t i = 0; i < colours.values.size(); ++i)
    colours.values[i] = painted.values[i].head<3>();
  return colours;
}

} // namespace kerf::texture
