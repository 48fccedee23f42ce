#pragma once

/// Planes that a vertex is to meet, the directions in which it may move, and the moves that take it there.
///
/// Method: seen from the allowed directions (projection P), planes with normals n_i have the quadric A = sum (P n_i)
/// (P n_i)^T [GH97]. Its eigenvectors with eigenvalues that are not small are the directions that the planes fix; the
/// others stay free. Eigenvectors come from cyclic Jacobi rotations, to round-off also for equal eigenvalues. No memory
/// is allocated: a cell has sixty segments, so at most so many planes.
///
/// Source: M. Garland, P. S. Heckbert, Surface simplification using quadric error metrics, SIGGRAPH 1997.

#include "base/vec.h"

#include <array>
#include <optional>

namespace kerf::surface {

struct Plane {
  Vec3 point, normal; ///< the normal is unit
};

/// A list of at most n items, in place.
template <class T, int n>
class Few {
 public:
  void push_back(const T& item) { items_[size_++] = item; }
  int size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T& operator[](const int i) const { return items_[i]; }
  const T& back() const { return items_[size_ - 1]; }
  const T* begin() const { return items_.data(); }
  const T* end() const { return items_.data() + size_; }

 private:
  std::array<T, n> items_;
  int size_ = 0;
};

using Planes = Few<Plane, 60>;
using Moves = Few<Vec3, 3>;

Vec3 mean_point(const Planes& planes);

/// A linear space of directions.
struct Directions {
  Mat3 projection = Mat3::Identity();
  int n = 3; ///< its dimension

  /// Takes out the part of v that is left in it; nothing where that is shorter than `least`.
  void remove(const Vec3& v, double least);
};

/// Eigenvalues of a symmetric matrix, largest first, and unit eigenvectors, in columns.
struct Spectrum {
  Vec3 values;
  Mat3 vectors;
};
Spectrum spectrum(const Mat3& symmetric);

/// What planes fix, as seen from the allowed directions: those directions whose singular value is above `least` (planes
/// that lean less than this against what may move fix nothing) and above `threshold` times the largest.
struct Fixed {
  Spectrum of; ///< the first n are fixed
  int n = 0;
};
constexpr double least_lean = 0.1;
Fixed fixed_directions(const Planes& planes, const Directions& allowed, double threshold, double least = least_lean);

/// The allowed directions along which all planes stay met.
Directions free_directions(const Planes& planes, const Directions& allowed, double threshold);

/// The smallest moves of p within the allowed directions that minimise the squared distances to the planes: first to
/// as many independent ones as there are, then to ever fewer, the weakest left out first. Never empty.
Moves moves_to_planes(const Vec3& p, const Planes& planes, const Directions& allowed, double threshold);

/// The plane that some planes all are, if p lies in it to within `near`; none where they differ, or there are none.
std::optional<Plane> common_plane(const Planes& planes, const Vec3& p, double near);

/// Where two planes meet in a triangle; none where they do not, or nearer than a thousandth of it to a side.
std::optional<Vec3> meeting_in(const std::array<Vec3, 3>& triangle, const Plane& a, const Plane& b);

} // namespace kerf::surface
