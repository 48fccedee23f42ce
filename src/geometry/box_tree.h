#pragma once

/// Which of many boxes overlap a given one: built once, queried often.
///
/// Method: a binary tree over the boxes, split at the median of their middles along the longest side of what the
/// middles span; a few boxes a leaf. Boxes are closed: two that only touch overlap.

#include "base/vec.h"

#include <span>
#include <vector>

namespace kerf::geometry {

Box box_around(std::span<const Vec3> points);
bool overlap(const Box& a, const Box& b);

class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes);

  /// Calls f(index) for each box that overlaps `box`, in no order that means anything.
  template <class Function>
  void for_each(const Box& box, const Function& f) const {
    if (!nodes_.empty())
      visit(0, box, f);
  }

 private:
  struct Node {
    Box box;
    std::uint32_t begin = 0, end = 0; // of order_
    std::uint32_t upper = 0;          // the second child; the first one follows its parent; 0 for a leaf
  };

  void build(std::uint32_t begin, std::uint32_t end);

  template <class Function>
  void visit(const std::uint32_t index, const Box& box, const Function& f) const {
    const Node& node = nodes_[index];
    if (!overlap(node.box, box))
      return;
    if (node.upper != 0) {
      visit(index + 1, box, f);
      visit(node.upper, box, f);
      return;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      if (overlap(boxes_[order_[i]], box))
        f(order_[i]);
  }

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

} // namespace kerf::geometry
