#pragma once

/// Random pairs with faces near their disks, and the definition of a mask: a ray test in double precision.

#include "visibility/rasteriser.h"

#include <Eigen/Geometry>

#include <random>

namespace kerf::visibility {

/// The generator is the standard's, the same everywhere; its distributions are not.
struct Random {
  std::mt19937 bits;
  explicit Random(const unsigned seed) : bits(seed) {}

  double number() { return bits() / 4294967296.; } // [0, 1)
  Vec3 vector() {                                  // in the cube [-1, 1)^3
    const double x = number(), y = number(), z = number();
    return Vec3(2 * x - 1, 2 * y - 1, 2 * z - 1);
  }
  Vec3 direction() {
    Vec3 v = vector();
    while (v.norm() > 1 || v.norm() < 0.1)
      v = vector();
    return v.normalized();
  }
};

/// Does the segment pq meet the triangle? Signs of volumes; a face seen edge-on is not met.
inline bool meets(const Vec3& p, const Vec3& q, const Face& face) {
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c) { return a.cross(b).dot(c); };
  const Vec3 d = q - p, a = face[0] - p, b = face[1] - p, c = face[2] - p;
  const double ab = volume(a, b, d), bc = volume(b, c, d), ca = volume(c, a, d), whole = volume(a, b, c);
  if (whole == 0)
    return false;
  const bool inside = whole > 0 ? ab >= 0 && bc >= 0 && ca >= 0 : ab <= 0 && bc <= 0 && ca <= 0;
  return inside && std::abs(ab + bc + ca) * end_of_lines >= std::abs(whole);
}

inline bool occluded(const Pair& pair, const Vec3& texel, const Face& face) {
  return meets(pair.a, texel, face) || meets(pair.b, texel, face);
}

/// The mask by the definition.
inline std::vector<std::uint32_t> ray_tested(const Pair& pair, const MaskShape& shape,
                                             const std::span<const Face> faces) {
  const Disk disk = make_disk(pair, shape);
  std::vector<std::uint32_t> mask(shape.resolution(), 0);
  for (int y = 0; y < shape.resolution(); ++y)
    for (int x = 0; x < shape.resolution(); ++x)
      for (const Face& face : faces)
        if (((shape.disk()[y] >> x) & 1u) && occluded(pair, texel_middle(disk, shape, x, y), face)) {
          mask[y] |= 1u << x;
          break;
        }
  return mask;
}

inline int n_different(const std::span<const std::uint32_t> a, const std::span<const std::uint32_t> b) {
  std::vector<std::uint32_t> difference;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference.push_back(a[i] ^ b[i]);
  return count(difference);
}

/// Pairs, each with `n_faces` faces of its own around its disk.
struct Disks {
  MaskShape shape;
  std::vector<Pair> pairs;
  std::vector<Face> faces;
  std::vector<std::uint32_t> indices, masks;

  explicit Disks(const MaskShape& s) : shape(s) {}

  std::span<const Face> faces_of(const std::size_t i) const {
    const std::size_t n = faces.size() / pairs.size();
    return std::span(faces).subspan(i * n, n);
  }
  std::span<std::uint32_t> mask_of(const std::size_t i) {
    return std::span(masks).subspan(i * shape.resolution(), shape.resolution());
  }
  std::vector<DiskUpdate> updates() {
    const std::size_t n = faces.size() / pairs.size();
    std::vector<DiskUpdate> found;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      found.push_back({make_disk(pairs[i], shape), std::span(indices).subspan(i * n, n), mask_of(i).data()});
    return found;
  }
};

/// The middles of the faces are within `spread` distances of the pair from the middle of the disk, their corners within
/// `size` distances from there.
inline Disks random_disks(const unsigned seed, const int n_pairs, const int n_faces, const double spread,
                          const double size, const MaskShape& shape = {32, 0.5}) {
  Random random(seed);
  Disks disks(shape);
  for (int i = 0; i < n_pairs; ++i) {
    const double distance = 0.02 + 0.2 * random.number();
    const Vec3 a = random.vector(), b = a + distance * random.direction();
    disks.pairs.push_back({a, b, 2 * distance});
    for (int k = 0; k < n_faces; ++k) {
      const Vec3 middle = 0.5 * a + 0.5 * b + spread * distance * random.vector();
      Face face;
      for (Vec3& corner : face)
        corner = middle + size * distance * random.vector();
      disks.faces.push_back(face);
      disks.indices.push_back(static_cast<std::uint32_t>(disks.indices.size()));
    }
  }
  disks.masks.assign(disks.pairs.size() * shape.resolution(), 0);
  return disks;
}

} // namespace kerf::visibility
