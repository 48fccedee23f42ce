#include "visibility/gl_rasteriser.h"

#include "gl/context.h"
#include "gl/framebuffer.h"
#include "gl/mesh.h"
#include "gl/program.h"
#include "gl/words.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace kerf::visibility {

namespace {

constexpr int n_tiles_a_side = 32;
constexpr std::size_t n_tiles = n_tiles_a_side * n_tiles_a_side;
constexpr int side_of_atlas = n_tiles_a_side * MaskShape::max_resolution; // [pixels]

struct Tile {
  int column, row;
};
Tile tile_of(const std::size_t i) {
  return {static_cast<int>(i) % n_tiles_a_side, static_cast<int>(i) / n_tiles_a_side};
}

/// The middle of a tile, -1 .. 1 over the atlas.
float middle(const int tile, const int resolution) {
  return static_cast<float>((2 * tile + 1) * resolution) / static_cast<float>(side_of_atlas) - 1;
}

/// Per vertex: position seen from the eye 3, middle of the tile 2.
void add_face(const Disk& disk, const Face& face, const int resolution, const int side, const Tile tile,
              std::vector<float>& vertices) {
  const double half = 0.5 * resolution;
  for (const Vec3& corner : face) {
    const Vec3 p = corner - disk.middle;
    const double z = disk.to_z.dot(p);
    for (const double value : {disk.to_x.dot(p) / half, disk.to_y.dot(p) / half, side == 0 ? 1 + z : 1 - z})
      vertices.push_back(static_cast<float>(value));
    vertices.push_back(middle(tile.column, resolution));
    vertices.push_back(middle(tile.row, resolution));
  }
}

std::vector<float> vertices_of(const MaskShape& shape, const std::span<const Face> faces,
                               const std::span<const DiskUpdate> updates) {
  std::vector<float> vertices;
  for (std::size_t i = 0; i < updates.size(); ++i)
    for (const std::uint32_t f : updates[i].faces)
      for (const int side : {0, 1})
        if (may_occlude(updates[i].disk, shape, faces[f], side))
          add_face(updates[i].disk, faces[f], shape.resolution(), side, tile_of(i), vertices);
  return vertices;
}

/// Texels that are occluded already or outside of the disk; the word of a row of texels stands at its pixel row.
std::vector<std::uint32_t> closed_texels(const MaskShape& shape, const std::span<const DiskUpdate> updates) {
  std::vector<std::uint32_t> words(std::size_t(n_tiles_a_side) * side_of_atlas, ~0u);
  for (std::size_t i = 0; i < updates.size(); ++i) {
    const Tile tile = tile_of(i);
    for (int y = 0; y < shape.resolution(); ++y)
      words[std::size_t(tile.row * shape.resolution() + y) * n_tiles_a_side + tile.column] =
        updates[i].mask[y] | ~shape.disk()[y];
  }
  return words;
}

/// Returns how many texels are written.
std::size_t add_written(const std::vector<std::uint8_t>& pixels, const int resolution,
                        const std::span<const DiskUpdate> updates) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < updates.size(); ++i) {
    const Tile tile = tile_of(i);
    for (int y = 0; y < resolution; ++y) {
      const std::uint8_t* const row =
        pixels.data() + 4 * (std::size_t(tile.row * resolution + y) * side_of_atlas + tile.column * resolution);
      std::uint32_t written = 0;
      for (int x = 0; x < resolution; ++x)
        written |= static_cast<std::uint32_t>(row[4 * x] & 1) << x;
      updates[i].mask[y] |= written;
      n += static_cast<std::size_t>(std::popcount(written));
    }
  }
  return n;
}

} // namespace

struct GlRasteriser::Atlas {
  gl::Context context;
  gl::Program program{"visibility.vert", "visibility.frag"};
  gl::Framebuffer image{{.width = side_of_atlas, .height = side_of_atlas, .depth = gl::Depth::none}};
  gl::Words closed{n_tiles_a_side, side_of_atlas};
  gl::Mesh mesh{3, 2};

  /// Returns how many texels are newly occluded.
  std::size_t draw(const MaskShape& shape, std::span<const Face> faces, std::span<const DiskUpdate> updates);
};

std::size_t GlRasteriser::Atlas::draw(const MaskShape& shape, const std::span<const Face> faces,
                                      const std::span<const DiskUpdate> updates) {
  constexpr float near = 1e-3f;
  const std::vector<float> vertices = vertices_of(shape, faces, updates);
  std::vector<std::uint32_t> indices(vertices.size() / 5);
  std::iota(indices.begin(), indices.end(), 0u);
  context.clip(4);
  mesh.upload(vertices, indices);
  closed.upload(closed_texels(shape, updates));
  closed.bind(0);
  const float tile = static_cast<float>(shape.resolution()) / static_cast<float>(side_of_atlas);
  program.set("tile_size", Eigen::Vector2f(tile, tile));
  program.set("planes", Eigen::Vector2f(near, static_cast<float>(end_of_lines)));
  program.set("closed", 0);
  program.set("resolution", shape.resolution());
  image.clear(Eigen::Vector4f::Zero());
  mesh.draw();
  return add_written(image.read_rgba8(), shape.resolution(), updates);
}

GlRasteriser::GlRasteriser() : atlas_(std::make_unique<Atlas>()) {}
// What the atlas holds is deleted in the context that is current.
GlRasteriser::~GlRasteriser() { atlas_->context.make_current(); }

void GlRasteriser::occlude(const MaskShape& shape, const std::span<const Face> faces,
                           const std::span<const DiskUpdate> updates) {
  atlas_->context.make_current();
  n_written_ = 0;
  for (std::size_t begin = 0; begin < updates.size(); begin += n_tiles)
    n_written_ += atlas_->draw(shape, faces, updates.subspan(begin, std::min(n_tiles, updates.size() - begin)));
}

} // namespace kerf::visibility
