#pragma once

/// The faces of a cut that only grows, and what lies across them.
///
/// Method: a box tree for each of a few contiguous ranges of faces; a range is merged with the one before it as soon as
/// it is no smaller, so n faces are in at most log n trees and each is sorted in log n times.

#include "geometry/box_tree.h"
#include "visibility/pair.h"

#include <span>

namespace kerf::visibility {

class CutFaces {
 public:
  /// Throws NumericalError if a coordinate is not finite.
  void add(std::span<const Face> faces);

  void archive(Archive& a);
  const std::vector<Face>& all() const { return faces_; }

  /// Calls f(index) for each face whose box overlaps `box`, in no order that means anything.
  template <class Function>
  void for_each(const Box& box, const Function& f) const {
    for (const Range& range : ranges_)
      range.tree.for_each(box, [&](const std::uint32_t i) { f(range.begin + i); });
  }

  /// The faces that the segment pq crosses (geometry::crosses), in increasing order.
  std::vector<std::uint32_t> crossed(const Vec3& p, const Vec3& q) const;
  /// Does the segment cross any face?
  bool separates(const Vec3& p, const Vec3& q) const { return !crossed(p, q).empty(); }

 private:
  struct Range {
    std::uint32_t begin, end;
    geometry::BoxTree tree;
  };

  void index(std::uint32_t begin, std::uint32_t end);

  std::vector<Face> faces_;
  std::vector<Range> ranges_;
};

} // namespace kerf::visibility
