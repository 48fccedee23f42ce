#pragma once

/// What of a body that planes have cut hangs on a piece of other sides.

#include "base/union_find.h"
#include "cut/sides.h"
#include "grid/material.h"
#include "grid/parts.h"
#include "tests/cut/patient.h"

#include <bit>
#include <map>

namespace kerf::cut {

/// Of the material that lies on other sides of these planes than most of its piece, what hangs together: the largest
/// volume of that [cubes]. A bridge, unless it is so small that it may be a splinter that the piece holds
/// (cut/splinters.h).
inline double largest_bridge(const Patient& patient, const std::vector<support::Plane>& planes) {
  const Body& body = patient.body;
  const grid::Pieces pieces = grid::pieces(body.complex);
  struct Bit {
    grid::CellId cell;
    grid::Part part;
    std::uint32_t piece;
    unsigned sides;
    double volume; // of a cube
  };
  std::vector<Bit> bits;
  std::vector<std::size_t> first(body.grid.n_cells() + 1, 0); // of each cell
  std::map<std::uint32_t, std::map<unsigned, double>> of_pieces;
  for (const auto c : ids<grid::CellId>(body.grid.n_cells())) {
    for (const grid::Part& part : grid::whole_parts_of(grid::without_joined(grid::cuts_of(body, c)))) {
      const Vec3 p = grid::item_point(body, c, std::countr_zero(part.items()));
      Bit bit{c, part, 0, 0, 0};
      for (std::size_t i = 0; i < planes.size(); ++i)
        bit.sides |= unsigned(planes[i].height(p) >= 0) << i;
      for (const grid::CopyId copy : body.complex.copies_of(c))
        if ((body.complex.copies[copy].items() & part.items()) != 0)
          bit.piece = pieces.piece[copy];
      for (const auto& [t, vertex] : grid::pieces_of(body, c, part.items()))
        bit.volume += grid::volume(t);
      of_pieces[bit.piece][bit.sides] += bit.volume;
      bits.push_back(bit);
    }
    first[c.value + 1] = bits.size();
  }
  UnionFind together(bits.size());
  const auto unite_if_same = [&](const std::size_t a, const std::size_t b) {
    if (bits[a].sides == bits[b].sides && bits[a].piece == bits[b].piece)
      together.unite(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
  };
  for (std::size_t a = 0; a < bits.size(); ++a) {
    const grid::CellId c = bits[a].cell;
    for (std::size_t b = first[c.value]; b < a; ++b)
      unite_if_same(a, b);
    for (int face = 1; face < grid::cube::n_faces; face += 2)
      if (const grid::CellId next = body.grid.neighbour(c, face); next.valid())
        for (std::size_t b = first[next.value]; b < first[next.value + 1]; ++b)
          if (are_glued_across(bits[a].part, bits[b].part, face))
            unite_if_same(a, b);
  }
  std::map<std::uint32_t, double> lumps; // of other sides
  for (std::size_t a = 0; a < bits.size(); ++a) {
    const auto& of_piece = of_pieces[bits[a].piece];
    const auto most = std::ranges::max_element(of_piece, {}, [](const auto& of) { return of.second; });
    if (bits[a].sides != most->first)
      lumps[together.root(static_cast<std::uint32_t>(a))] += bits[a].volume;
  }
  double largest = 0;
  for (const auto& [root, volume] : lumps)
    largest = std::max(largest, volume);
  return largest;
}

} // namespace kerf::cut
