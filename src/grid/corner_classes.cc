#include "grid/corner_classes.h"

#include "grid/cube.h"
#include "grid/solid.h"

#include <algorithm>

namespace kerf::grid {

void CellsAround::complete(const Grid& grid) {
  // Once along each axis finds all eight, where all are there; else a gap may make the way longer.
  for (std::size_t n_before = 0, n = 1; n_before < n && n < 8;) {
    n_before = n;
    for (int axis = 0; axis < 3; ++axis)
      for (int v = 0; v < 8; ++v)
        if (const int other = v ^ 1 << axis; cells_[v].valid() && !cells_[other].valid())
          cells_[other] = grid.neighbour(cells_[v], cube::face_at(v, axis));
    n = std::count_if(cells_.begin(), cells_.end(), [](const CellId c) { return c.valid(); });
  }
}

CornerClasses::CornerClasses(const Solid& solid, const CellComplex& complex, const CellsAround& cells) {
  for (int v = 0; v < 8; ++v) {
    first_slot_[v] = static_cast<std::uint16_t>(n_slots_);
    for (CopyId c = cells.at(v).valid() ? complex.first_copy[cells.at(v)] : CopyId(); c.valid();
         c = complex.copies[c].next) {
      slots_[n_slots_] = {c, static_cast<std::uint8_t>(v), static_cast<std::uint16_t>(n_slots_)};
      parts_[n_slots_++] = complex.copies[c].part();
    }
  }
  first_slot_[8] = static_cast<std::uint16_t>(n_slots_);
  if (!solid.cuts.fronts().empty())
    tell_skin(solid, cells);
  n_classes_ = static_cast<int>(n_slots_);
  for (int v = 0; v < 8; ++v)
    for (int axis = 0; axis < 3; ++axis)
      if ((v >> axis & 1) && n_classes_ > 1)
        join_across(v, axis);
  number();
}

/// A front parts its own cell, not the one ahead of it: a point of the skin in the face between them may be with one node
/// there and with another one here. So copies that tell of nodes alone are told of such points.
void CornerClasses::tell_skin(const Solid& solid, const CellsAround& cells) {
  const auto has_front = [&](const int v) { return cells.at(v).valid() && solid.cuts.front(cells.at(v)) != nullptr; };
  bool is_at_front = false;
  for (int v = 0; v < 8; ++v)
    is_at_front |= has_front(v);
  for (int v = 0; v < 8 && is_at_front; ++v) {
    const auto parts = std::span(parts_).subspan(first_slot_[v], first_slot_[v + 1] - first_slot_[v]);
    if (parts.empty() || std::ranges::any_of(parts, [](const Part& part) { return part.skin != 0; }))
      continue;
    const CellCuts cuts = cuts_of(solid, cells.at(v));
    if (!cuts.has_skin())
      continue;
    const Parts whole = whole_parts_of(cuts);
    for (Part& part : parts)
      part = *std::ranges::find_if(whole, [&](const Part& other) { return (other.nodes & part.nodes) != 0; });
  }
}

/// The cell in which the node is the upper vertex along the axis lies below the other one.
void CornerClasses::join_across(const int upper_vertex, const int axis) {
  const int lower_vertex = upper_vertex ^ 1 << axis;
  for (int a = first_slot_[upper_vertex]; a < first_slot_[upper_vertex + 1]; ++a)
    for (int b = first_slot_[lower_vertex]; b < first_slot_[lower_vertex + 1]; ++b) {
      if (!are_glued(parts_[a], parts_[b], axis))
        continue;
      const std::uint16_t p = slots_[a].class_number, q = slots_[b].class_number;
      if (p == q)
        continue;
      --n_classes_;
      for (std::size_t i = 0; i < n_slots_; ++i)
        if (slots_[i].class_number == std::max(p, q))
          slots_[i].class_number = std::min(p, q);
    }
}

void CornerClasses::number() {
  std::array<std::uint16_t, max_slots> number_of;
  std::uint16_t n = 0;
  for (std::size_t i = 0; i < n_slots_; ++i) {
    auto& name = slots_[i].class_number; // the first slot of the class
    if (name == i)
      number_of[i] = n++;
    name = number_of[name];
  }
}

} // namespace kerf::grid
