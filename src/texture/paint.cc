#include "texture/paint.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/parameters.h"

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

/// Luminance in a tile and around it, and what its windows say.
struct Windows {
  int width, height, gutter, stride;
  std::vector<float> luminance;              ///< with the gutter
  std::vector<float> mean, sharpness, place; ///< of the tile alone

  float* row(const int r) { return &luminance[static_cast<std::size_t>(r + gutter) * (width + 2 * gutter) + gutter]; }
};

/// Calls f(row of the tile's values, row of values shifted) for each of the 49 shifts.
template <class Function>
void for_each_shift(Windows& w, const int r, const Function& f) {
  for (int dr = -window_radius; dr <= window_radius; ++dr)
    for (int dc = -window_radius; dc <= window_radius; ++dc)
      f(w.row(r + dr * w.stride) + dc * w.stride);
}

/// Mean, spread and each value's place in its window: the share of values below it. Counted softly, so that it changes
/// continuously: a value within a quarter of the spread counts in part.
void find_places(Windows& w, const int r, const Span& span) {
  constexpr float n = (2 * window_radius + 1) * (2 * window_radius + 1);
  float* const mean = &w.mean[static_cast<std::size_t>(r) * w.width];
  float* const sharpness = &w.sharpness[static_cast<std::size_t>(r) * w.width];
  float* const place = &w.place[static_cast<std::size_t>(r) * w.width];
  const float* const own = w.row(r);
  for_each_shift(w, r, [&](const float* value) {
    for (int c = span.first; c <= span.last; ++c) {
      const float v = value[c];
      mean[c] += v;
      sharpness[c] += v * v;
    }
  });
  for (int c = span.first; c <= span.last; ++c) {
    mean[c] /= n;
    const float variance = std::max(0.0f, sharpness[c] / n - mean[c] * mean[c]);
    sharpness[c] = 1 / (0.25f * std::sqrt(variance) + 0.002f);
  }
  for_each_shift(w, r, [&](const float* value) {
    for (int c = span.first; c <= span.last; ++c)
      place[c] += std::min(std::max((own[c] - value[c]) * sharpness[c] + 0.5f, 0.0f), 1.0f);
  });
  for (int c = span.first; c <= span.last; ++c)
    place[c] /= n;
}

/// The columns of row r that the windows of the rows around it reach; r may lie outside of the tile.
Span reached(const std::vector<Span>& rows, const int r, const int gutter) {
  Span span{1 << 20, -(1 << 20)};
  for (int k = std::max(0, r - gutter); k <= std::min(static_cast<int>(rows.size()) - 1, r + gutter); ++k)
    if (rows[k].last >= rows[k].first) {
      span.first = std::min(span.first, rows[k].first - gutter);
      span.last = std::max(span.last, rows[k].last + gutter);
    }
  return span;
}

/// `rows` are spans of the tile's columns.
void paint_detailed(const Interior& interior, const Patch& patch, const Detail& detail, const Blending& how,
                    const int stride, const Tile& tile, const std::vector<Span>& rows, Painted& out) {
  const int gutter = window_radius * stride;
  const std::size_t size = static_cast<std::size_t>(tile.width) * tile.height;
  const std::size_t with_gutter = static_cast<std::size_t>(tile.width + 2 * gutter) * (tile.height + 2 * gutter);
  Windows w{tile.width,
            tile.height,
            gutter,
            stride,
            std::vector<float>(with_gutter),
            std::vector<float>(size),
            std::vector<float>(size),
            std::vector<float>(size)};
  std::vector<Blend> blends(size);
  for (int r = -gutter; r < tile.height + gutter; ++r) {
    const Span span = reached(rows, r, gutter);
    for (int c = span.first; c <= span.last; ++c) {
      const Blend blend = interior.blend(patch.point(tile.left + c, tile.top + r), how);
      const Eigen::Array4f colour = interior.colour(blend);
      w.row(r)[c] = colour[3];
      if (r >= 0 && c >= 0 && r < tile.height && c < tile.width) {
        blends[static_cast<std::size_t>(r) * tile.width + c] = blend;
        out(tile.left + c, tile.top + r) = colour;
      }
    }
  }
  for (int r = 0; r < tile.height; ++r) {
    find_places(w, r, rows[r]);
    for (int c = rows[r].first; c <= rows[r].last; ++c) {
      const std::size_t i = static_cast<std::size_t>(r) * tile.width + c;
      Eigen::Array4f& colour = out(tile.left + c, tile.top + r);
      const float change = detail.luminance(blends[i], w.place[i]) - (colour[3] - w.mean[i]);
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
      paint_detailed(interior, patch, *detail, how, stride, tiles[i],
                     std::vector<Span>(tiles[i].height, Span{0, tiles[i].width - 1}), out);
    else
      paint_plain(interior, patch, how, tiles[i], out);
  });
  return out;
}

Painted paint(const Interior& interior, const Patch& patch, const Detail* detail) {
  return paint(interior, patch, detail, interior.options().blending);
}

Painted paint_spans(const Interior& interior, const Patch& patch, const Detail& detail, const std::vector<Span>& rows) {
  Painted out(patch.width, patch.height, Eigen::Array4f::Zero());
  paint_detailed(interior, patch, detail, interior.options().blending, stride_of(interior, patch),
                 {0, 0, patch.width, patch.height}, rows, out);
  return out;
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
