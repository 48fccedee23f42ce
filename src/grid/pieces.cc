#include "base/parallel.h"
#include "base/shared_union_find.h"
#include "base/union_find.h"
#include "grid/complex.h"
#include "grid/cube.h"
#include "grid/solid.h"

namespace kerf::grid {

namespace {

constexpr std::uint32_t no_piece = Id<void>::no_value;

/// What lies around a cut: the copies of cells that it has changed, and of two rings of neighbours.
std::vector<CopyId> copies_around(const Solid& solid, const CutChange& change) {
  constexpr int n_rings = 2; // so many join the sides of a cut ahead of its front
  Table<CellId, std::uint8_t> is_near(solid.grid.n_cells(), 0);
  std::vector<CellId> cells;
  const auto add = [&](const CellId cell) {
    if (!cell.valid() || is_near[cell] != 0)
      return;
    is_near[cell] = 1;
    cells.push_back(cell);
  };
  for (const CopyId c : change.copies)
    add(solid.complex.copies[c].cell);
  for (const CellId cell : change.cells)
    add(cell);
  std::size_t begin = 0;
  for (int ring = 0; ring < n_rings; ++ring)
    for (const std::size_t end = cells.size(); begin < end; ++begin)
      for (int face = 0; face < cube::n_faces; ++face)
        add(solid.grid.neighbour(cells[begin], face));
  std::vector<CopyId> copies;
  for (const CellId cell : cells)
    for (const CopyId c : solid.complex.copies_of(cell))
      copies.push_back(c);
  return copies;
}

} // namespace

/// Copies that a cut has not changed hang together as they did, but for ways through those that it has. If around the
/// cut all that were in one piece still hang together, every way through it can be gone around: then pieces are what
/// they were, and what is new belongs to what it hangs on.
bool update_pieces(const Solid& solid, const CutChange& change, Pieces& pieces) {
  const CellComplex& complex = solid.complex;
  const auto anew = [&] {
    pieces = grid::pieces(complex);
    return false;
  };
  if (!complex.lapsed.empty())
    return anew();
  const std::vector<CopyId> around = copies_around(solid, change);
  Table<CopyId, std::uint32_t> place(complex.n_copies(), no_piece);
  Table<CornerId, std::uint32_t> owner(complex.n_corners(), no_piece);
  UnionFind sets(around.size());
  for (std::uint32_t i = 0; i < around.size(); ++i) {
    place[around[i]] = i;
    for (const CornerId corner : complex.copies[around[i]].corners)
      if (owner[corner] == no_piece)
        owner[corner] = i;
      else
        sets.unite(owner[corner], i);
  }
  for (const auto& [c, d] : complex.tied)
    if (place[c] != no_piece && place[d] != no_piece)
      sets.unite(place[c], place[d]);
  std::vector<std::uint8_t> is_changed(around.size(), 0);
  for (const CopyId c : change.copies) {
    if (place[c] == no_piece)
      return anew();
    is_changed[place[c]] = 1;
  }
  std::vector<std::uint32_t> piece_of(around.size(), no_piece), set_of(pieces.n_pieces, no_piece);
  for (std::uint32_t i = 0; i < around.size(); ++i)
    if (is_changed[i] == 0) {
      const std::uint32_t piece = pieces.piece[around[i]], set = sets.root(i);
      if ((piece_of[set] != no_piece && piece_of[set] != piece) || (set_of[piece] != no_piece && set_of[piece] != set))
        return anew();
      piece_of[set] = piece;
      set_of[piece] = set;
    }
  const std::size_t n_before = pieces.piece.size();
  for (const CopyId c : change.copies) {
    const std::uint32_t piece = piece_of[sets.root(place[c])];
    if (piece == no_piece || (c.value < n_before && pieces.piece[c] != piece))
      return anew();
  }
  pieces.piece.resize(complex.n_copies());
  for (const CopyId c : change.copies)
    pieces.piece[c] = piece_of[sets.root(place[c])];
  return true;
}

Pieces pieces(const CellComplex& complex) {
  constexpr std::size_t worth = 4096; // copies from which on a second thread pays
  SharedUnionFind corners(complex.n_corners());
  const auto first = [](const Copy& copy) { return copy.corners[0].value; };
  parallel_for(
    complex.n_copies(),
    [&](const std::size_t c) {
      const Copy& copy = complex.copies[CopyId(c)];
      std::uint32_t root = first(copy);
      for (const CornerId corner : copy.corners) // that others have too where they are glued, and only there
        root = corners.unite(root, corner.value);
    },
    worth);
  for (const auto& [c, d] : complex.tied)
    corners.unite(first(complex.copies[c]), first(complex.copies[d]));
  Pieces result;
  Table<CornerId, std::uint32_t> number(complex.n_corners(), no_piece);
  result.piece.reserve(complex.n_copies());
  for (const Copy& copy : complex.copies) {
    std::uint32_t& piece = number[CornerId(corners.root(first(copy)))];
    if (piece == no_piece)
      piece = result.n_pieces++;
    result.piece.push_back(piece);
  }
  return result;
}

std::vector<std::uint32_t> corner_pieces(const CellComplex& complex) {
  return corner_pieces(complex, pieces(complex));
}

std::vector<std::uint32_t> corner_pieces(const CellComplex& complex, const Pieces& all) {
  std::vector<std::uint32_t> result(complex.n_corners());
  if (all.n_pieces == 1)
    return result;
  for (const auto c : ids<CopyId>(complex.n_copies()))
    for (const CornerId corner : complex.copies[c].corners)
      result[corner.value] = all.piece[c];
  return result;
}

} // namespace kerf::grid
