#pragma once

/// The colours of revealed triangles, finer than the triangles (thesis §3.4.1, §3.5).
///
/// A triangle that is divided into n parts a side has a colour at each of the (n + 1)(n + 2) / 2 points of its lattice,
/// its corners included: so neighbours agree at what they share, and nothing is packed or distorted. A triangle is filled
/// when it appears, and again only if its corners have moved in the rest configuration or its label has changed. Its
/// samples stay where they are until then; then their places are free, for what is filled in the same fill already. Both
/// sides of a cut lie on each other at rest: one is copied from the other.

#include "base/archive.h"
#include "texture/flat.h"
#include "texture/free_places.h"
#include "texture/paint.h"
#include "texture/sample_points.h"
#include "texture/skin.h"

#include <cstdint>
#include <span>

namespace kerf::texture {

struct Brush;

/// A surface in the rest configuration.
struct SurfaceView {
  std::span<const Vec3> rest; ///< vertices [m]
  std::span<const Triangle> triangles;
  std::span<const std::uint16_t> labels; ///< one a triangle; 0 is the skin
};

/// What triangles are painted with.
struct Paint {
  const Interior* inside = nullptr; ///< revealed triangles
  const Detail* detail = nullptr;   ///< null: without small features
  const Skin* skin = nullptr;       ///< null: the skin gets no samples
  double relief = 0;                ///< height of white above black [m]; 0: no slopes are kept
};

class Atlas {
 public:
  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr int max_parts = 64; ///< a side; larger triangles than this allows are coarser, and counted

  /// Samples are as fine as square pixels with sides of `resolution` [m].
  explicit Atlas(const double resolution) : resolution_(resolution) {}

  static double bytes_a_sample(const double relief) { return relief != 0 ? 11 : 3; } ///< colour, and slopes

  /// Fills what is new. Returns the number of triangles filled. The cost beside them: one look at each triangle.
  std::size_t fill(const SurfaceView& surface, const Paint& paint);

  void archive(Archive& a) { a(first_, parts_, fill_of_, n_fills_, colours_, slopes_, filled_, labels_, places_); }

  /// Triangles whose samples are farther apart than asked for.
  std::size_t n_coarse() const;
  const std::vector<std::uint32_t>& first() const { return first_; } ///< sample of each triangle; none
  const std::vector<std::uint16_t>& parts() const { return parts_; } ///< n of each triangle; 0 without samples
  /// Number of the fill, from 1 on, that each triangle's samples are of; 0 without.
  const std::vector<std::uint32_t>& fill_of() const { return fill_of_; }
  std::uint32_t n_fills() const { return n_fills_; } ///< in which there was something new
  /// Samples, sRGB; those at places that are free are of triangles that have gone.
  const std::vector<std::array<std::uint8_t, 3>>& colours() const { return colours_; }
  /// By how much the relief rises along the triangle's first and second edge, at each sample [m]; empty without relief.
  const std::vector<std::array<float, 2>>& slopes() const { return slopes_; }

 private:
  void give_back(std::size_t t);
  std::vector<std::size_t> lay_out(const SurfaceView& surface, const Paint& paint);
  void fill_skin(std::size_t t, const Skin& skin);
  std::vector<FlatGroup> groups_of(const std::vector<std::size_t>& revealed, const Paint& paint) const;
  std::vector<std::size_t> parts_of(const std::vector<FlatGroup>& groups, std::size_t most) const;
  void fill_groups(std::span<const FlatGroup> groups, const Paint& paint, Brush& brush);
  void copy(const Twin& twin);

  double resolution_;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint16_t> parts_;
  std::vector<std::uint32_t> fill_of_;
  std::uint32_t n_fills_ = 0;
  std::vector<std::array<std::uint8_t, 3>> colours_;
  std::vector<std::array<float, 2>> slopes_;
  std::vector<Corners> filled_; // the corners that each triangle was filled for
  std::vector<std::uint16_t> labels_;
  FreePlaces places_; // of samples
};

/// How many samples revealed faces of that area take [m^2] where a plane cuts cubes along a layer of them: in triangles
/// with two sides of half a cube's edge at a right angle. Elsewhere there are more and smaller triangles.
double n_samples_of(double area, double resolution, double cube_edge);

} // namespace kerf::texture
