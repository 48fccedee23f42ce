#pragma once

/// The two criteria that lengthen the distance of a pair whose segment is crossed (thesis §2.3.1; Organ, Fleming,
/// Terry, Belytschko 1996). s_0 is the distance, x_c a point of the front.
///
/// Diffraction (2.34): d = ((s_1 + s_2) / s_0)^gamma s_0, the shortest path a - x_c - b around one point of an open
/// front edge that crosses no face. For each edge x_c is in closed form: unfold both points into one plane.
/// Transparency (2.35): d = s_0 + rho (s_c / s_0)^gamma, with s_c from where the segment meets the face to the nearest
/// open front edge of the same sheet, and rho the support of the kernel; of several faces crossed, the farthest.
/// Where there is no such path, the pair is cut off: factor 0.
///
/// Limits: a path has one bend: around two fronts one behind the other there is none. A path longer than the support is
/// not looked for: its weight is 0 anyhow, as is that of s_c >= s_0 by (2.35). The front is found anew whenever the cut
/// has grown: n log n for n faces.

#include "visibility/criterion.h"
#include "visibility/front.h"

namespace kerf::visibility {

/// Where a path from a to b around the segment from - to bends: the point of the segment with the least |ax| + |xb|.
Vec3 bend(const Vec3& a, const Vec3& b, const Vec3& from, const Vec3& to);

class Diffraction : public Criterion {
 public:
  /// gamma >= 1 [1].
  explicit Diffraction(double gamma) : gamma_(gamma) {}

  Box reach(const Pair& pair) const override;
  bool concerns(const Pair& pair, const pba::Sight& sight, const Face& face) const override;
  void watch(PairId, std::span<const Pair>) override {}
  void look(const CutFaces& cut, const Table<PairId, Pair>& pairs, std::span<const Work> works,
            Sights& sights) override;

 private:
  pba::Sight sight(const CutFaces& cut, const Pair& pair) const;

  double gamma_;
  std::size_t n_faces_ = 0; // the front is of
  std::optional<Front> front_;
};

class Transparency : public Criterion {
 public:
  /// gamma >= 2 [1].
  explicit Transparency(double gamma) : gamma_(gamma) {}

  Box reach(const Pair& pair) const override;
  bool concerns(const Pair& pair, const pba::Sight& sight, const Face& face) const override;
  void watch(PairId, std::span<const Pair>) override {}
  void look(const CutFaces& cut, const Table<PairId, Pair>& pairs, std::span<const Work> works,
            Sights& sights) override;

 private:
  pba::Sight sight(const CutFaces& cut, const Pair& pair) const;

  double gamma_;
  std::size_t n_faces_ = 0; // the front is of
  std::optional<Front> front_;
};

} // namespace kerf::visibility
