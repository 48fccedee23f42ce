#pragma once

/// Which slots (copy, vertex) at one node are one corner: those that gluing joins, face by face (complex.h).

#include "grid/complex.h"

namespace kerf::grid {

/// Stored cells around a node, by the vertex that the node is in them.
class CellsAround {
 public:
  void add(const CellId cell, const int vertex) { cells_[vertex] = cell; }
  /// Adds all cells around the node that can be reached from those here across faces at the node. Others have no slots
  /// in common with them.
  void complete(const Grid& grid);

  CellId at(const int vertex) const { return cells_[vertex]; }

 private:
  std::array<CellId, 8> cells_;
};

class CornerClasses {
 public:
  static constexpr int max_slots = 8 * skeleton::n_items; ///< copies in each of eight cells

  struct Slot {
    CopyId copy;
    std::uint8_t vertex;
    std::uint16_t class_number; ///< from 0, in the order of the classes' first slots
  };

  /// Of a complex of the solid's cells, which need not be the solid's as yet.
  CornerClasses(const Solid& solid, const CellComplex& complex, const CellsAround& cells);

  int n_classes() const { return n_classes_; }
  /// By vertex, then along the cell's copies.
  std::span<const Slot> slots() const { return {slots_.data(), n_slots_}; }

 private:
  void tell_skin(const Solid& solid, const CellsAround& cells);
  void join_across(int upper_vertex, int axis);
  void number();

  std::array<Slot, max_slots> slots_;
  std::array<Part, max_slots> parts_;       // of the slots' copies; beside a front with points of the skin
  std::array<std::uint16_t, 9> first_slot_; // by vertex
  std::size_t n_slots_ = 0;
  int n_classes_ = 0;
};

} // namespace kerf::grid
