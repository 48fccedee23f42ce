#include "grid/complex.h"

#include "base/parallel.h"
#include "base/union_find.h"
#include "grid/corner_classes.h"
#include "grid/cube.h"
#include "grid/touched.h"

#include <algorithm>
#include <bit>

namespace kerf::grid {

namespace {

constexpr std::size_t cells_per_chunk = 4096;
constexpr std::uint32_t none = Id<void>::no_value;

/// Room for some cuts, so that the first ones do not move the whole table.
std::size_t with_room(const std::size_t n) { return n + n / 8; }

std::uint8_t material_bits(const Grid& grid, const CellId c) {
  unsigned bits = 0;
  for (int v = 0; v < 8; ++v)
    bits |= unsigned(grid.is_material(grid.nodes(c)[v])) << v;
  return static_cast<std::uint8_t>(bits);
}

/// The material components of a set of vertices, by lowest vertex.
struct Components {
  int n = 0;
  std::array<std::uint8_t, 8> nodes{};

  Components(const unsigned material, const unsigned cut_lines) {
    for (unsigned left = material; left != 0; left &= ~unsigned(nodes[n++]))
      nodes[n] = cube::reachable(std::countr_zero(left), cut_lines);
  }
};

/// The cells with cut lines among some of them in a row.
struct Chunk {
  struct CutCell {
    CellId cell;
    Components components;
  };
  std::vector<CutCell> cut_cells;
  std::size_t first_copy = 0;
};

template <class Function>
void for_each_cell(const Grid& grid, const std::size_t chunk, const Function& f) {
  const std::size_t end = std::min(grid.n_cells(), (chunk + 1) * cells_per_chunk);
  for (std::size_t c = chunk * cells_per_chunk; c < end; ++c)
    f(CellId(c));
}

std::vector<Chunk> make_chunks(const Grid& grid, const Cuts& cuts) {
  std::vector<Chunk> chunks((grid.n_cells() + cells_per_chunk - 1) / cells_per_chunk);
  parallel_for(chunks.size(), [&](const std::size_t k) {
    for_each_cell(grid, k, [&](const CellId c) {
      if (const unsigned cut_lines = cuts.configuration(grid, c); cut_lines != 0)
        chunks[k].cut_cells.push_back({c, Components(material_bits(grid, c), cut_lines)});
    });
  });
  return chunks;
}

/// Numbers the chunks' first copies; returns how many copies there are.
std::size_t count_copies(const Grid& grid, std::vector<Chunk>& chunks) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < chunks.size(); ++k) {
    chunks[k].first_copy = n;
    n += std::min(grid.n_cells(), (k + 1) * cells_per_chunk) - k * cells_per_chunk - chunks[k].cut_cells.size();
    for (const auto& cut : chunks[k].cut_cells)
      n += cut.components.n;
  }
  return n;
}

void make_copies(const Grid& grid, std::vector<Chunk>& chunks, CellComplex& complex) {
  const std::size_t n_copies = count_copies(grid, chunks);
  complex.first_copy.resize(grid.n_cells());
  complex.copies.reserve(with_room(n_copies));
  complex.copies.resize(n_copies);
  parallel_for(chunks.size(), [&](const std::size_t k) {
    std::size_t copy = chunks[k].first_copy;
    auto cut = chunks[k].cut_cells.begin();
    for_each_cell(grid, k, [&](const CellId c) {
      complex.first_copy[c] = CopyId(copy);
      if (cut == chunks[k].cut_cells.end() || cut->cell != c) {
        complex.copies[CopyId(copy++)] = {c, 0xff, {}, {}};
        return;
      }
      for (int i = 0; i < cut->components.n; ++i, ++copy)
        complex.copies[CopyId(copy)] = {
          c, cut->components.nodes[i], {}, i + 1 < cut->components.n ? CopyId(copy + 1) : CopyId()};
      ++cut;
    });
  });
}

/// The cut cells around each node, as lists through their slots (cell, vertex).
class SlotsOfNodes {
 public:
  SlotsOfNodes(const Grid& grid, const std::vector<Chunk>& chunks) : first_(grid.n_nodes(), none) {
    std::size_t n_cut_cells = 0;
    for (const Chunk& chunk : chunks)
      n_cut_cells += chunk.cut_cells.size();
    slots_.reserve(8 * n_cut_cells);
    for (const Chunk& chunk : chunks)
      for (const auto& cut : chunk.cut_cells)
        for (int v = 0; v < 8; ++v) {
          std::uint32_t& first = first_[grid.nodes(cut.cell)[v]];
          slots_.push_back({cut.cell, first});
          first = static_cast<std::uint32_t>(slots_.size() - 1);
        }
  }

  bool has(const NodeId node) const { return first_[node] != none; }
  CellsAround cells_around(const Grid& grid, const NodeId node) const {
    CellsAround cells;
    for (std::uint32_t i = first_[node]; i != none; i = slots_[i].next)
      cells.add(slots_[i].cell, i % 8);
    cells.complete(grid);
    return cells;
  }

 private:
  struct Slot {
    CellId cell;
    std::uint32_t next;
  };
  Table<NodeId, std::uint32_t> first_;
  std::vector<Slot> slots_;
};

/// Numbers the corners by node. A node that no cut cell touches has one, which its cells find by `lone_corner`.
Table<NodeId, CornerId> number_corners(const Grid& grid, const SlotsOfNodes& slots, CellComplex& complex) {
  Table<NodeId, CornerId> lone_corner(grid.n_nodes());
  complex.node.reserve(with_room(grid.n_nodes()));
  complex.real_corner.resize(grid.n_nodes());
  for (const NodeId node : ids<NodeId>(grid.n_nodes())) {
    if (!slots.has(node)) {
      lone_corner[node] = complex.real_corner[node] = complex.node.push_back(node);
      continue;
    }
    const CornerClasses classes(complex, slots.cells_around(grid, node));
    const std::size_t first = complex.n_corners();
    complex.node.resize(first + classes.n_classes(), node);
    for (const auto& slot : classes.slots()) {
      const CornerId corner(first + slot.class_number);
      Copy& copy = complex.copies[slot.copy];
      copy.corners[slot.vertex] = corner;
      if (copy.nodes >> slot.vertex & 1)
        complex.real_corner[node] = corner;
    }
  }
  return lone_corner;
}

void make_corners(const Grid& grid, const std::vector<Chunk>& chunks, CellComplex& complex) {
  const auto lone_corner = number_corners(grid, SlotsOfNodes(grid, chunks), complex);
  parallel_for(
    complex.n_copies(),
    [&](const std::size_t c) {
      Copy& copy = complex.copies[CopyId(c)];
      const auto& nodes = grid.nodes(copy.cell);
      for (int v = 0; v < 8; ++v)
        if (const CornerId corner = lone_corner[nodes[v]]; corner.valid())
          copy.corners[v] = corner;
    },
    cells_per_chunk);
}

/// Splits copies and renames corners around new cut edges.
class Update {
 public:
  Update(const Grid& grid, const Cuts& cuts, CellComplex& complex)
    : grid_(grid), cuts_(cuts), complex_(complex), change_{complex.n_copies(), complex.n_corners(), {}, {}} {}

  ComplexChange run(const std::span<const EdgeId> new_edges) {
    for (const TouchedCell& touched : touched_cells(grid_, new_edges))
      split(touched.cell);
    std::sort(slots_.begin(), slots_.end());
    for (auto slot = slots_.begin(); slot != slots_.end();) {
      const NodeId node = slot->node;
      CellsAround cells;
      for (; slot != slots_.end() && slot->node == node; ++slot)
        cells.add(slot->cell, slot->vertex);
      cells.complete(grid_);
      rename(node, CornerClasses(complex_, cells));
    }
    std::sort(change_.copies.begin(), change_.copies.end());
    change_.copies.erase(std::unique(change_.copies.begin(), change_.copies.end()), change_.copies.end());
    return std::move(change_);
  }

 private:
  struct Slot {
    NodeId node;
    int vertex;
    CellId cell;
    auto operator<=>(const Slot&) const = default;
  };

  void split(const CellId cell) {
    const unsigned cut_lines = cuts_.configuration(grid_, cell);
    bool splits = false;
    for (CopyId c = complex_.first_copy[cell]; c.valid();) {
      const CopyId next = complex_.copies[c].next;
      const Components components(complex_.copies[c].nodes, cut_lines);
      splits |= components.n > 1;
      if (components.n > 1)
        divide(c, components);
      c = next;
    }
    if (splits) {
      sort_copies(cell);
      for (int v = 0; v < 8; ++v)
        slots_.push_back({grid_.nodes(cell)[v], v, cell});
    }
  }

  /// The first component keeps the copy; the others start with its corners, and stand behind it.
  void divide(const CopyId c, const Components& components) {
    complex_.copies[c].nodes = components.nodes[0];
    change_.copies.push_back(c);
    for (int i = 1; i < components.n; ++i) {
      Copy copy = complex_.copies[c];
      copy.nodes = components.nodes[i];
      const CopyId added = complex_.copies.push_back(copy);
      complex_.copies[c].next = added;
      change_.copies.push_back(added);
    }
  }

  void sort_copies(const CellId cell) {
    std::array<CopyId, 8> copies;
    int n = 0;
    for (const CopyId c : complex_.copies_of(cell))
      copies[n++] = c;
    std::sort(copies.begin(), copies.begin() + n, [&](const CopyId a, const CopyId b) {
      return std::countr_zero(complex_.copies[a].nodes) < std::countr_zero(complex_.copies[b].nodes);
    });
    complex_.first_copy[cell] = copies[0];
    for (int i = 0; i < n; ++i)
      complex_.copies[copies[i]].next = i + 1 < n ? copies[i + 1] : CopyId();
  }

  void rename(const NodeId node, const CornerClasses& classes) {
    std::array<CornerId, CornerClasses::max_slots> corner_of;
    for (int k = 0; k < classes.n_classes(); ++k)
      corner_of[k] = CornerId();
    for (const auto& slot : classes.slots()) { // the class with the node's own material keeps its corner ...
      const Copy& copy = complex_.copies[slot.copy];
      if (copy.nodes >> slot.vertex & 1)
        corner_of[slot.class_number] = copy.corners[slot.vertex];
    }
    for (const auto& slot : classes.slots()) // ... else the first of those that come from one corner
      if (CornerId& corner = corner_of[slot.class_number]; !corner.valid()) {
        const CornerId old = complex_.copies[slot.copy].corners[slot.vertex];
        const auto end = corner_of.begin() + classes.n_classes();
        corner = std::find(corner_of.begin(), end, old) == end ? old : new_corner(node, old);
      }
    for (const auto& slot : classes.slots())
      if (CornerId& corner = complex_.copies[slot.copy].corners[slot.vertex]; corner != corner_of[slot.class_number]) {
        corner = corner_of[slot.class_number];
        change_.copies.push_back(slot.copy);
      }
  }

  CornerId new_corner(const NodeId node, const CornerId parent) {
    change_.parents.push_back(parent);
    return complex_.node.push_back(node);
  }

  const Grid& grid_;
  const Cuts& cuts_;
  CellComplex& complex_;
  ComplexChange change_;
  std::vector<Slot> slots_; // of the cells that split
};

} // namespace

CopyId CellComplex::copy_at(const CellId cell, const int vertex) const {
  for (CopyId c = first_copy[cell]; c.valid(); c = copies[c].next)
    if (copies[c].nodes >> vertex & 1)
      return c;
  return {};
}

std::size_t CellComplex::n_bytes() const {
  return copies.items().capacity() * sizeof(Copy) + first_copy.items().capacity() * sizeof(CopyId) +
         node.items().capacity() * sizeof(NodeId) + real_corner.items().capacity() * sizeof(CornerId);
}

CellComplex build_complex(const Grid& grid, const Cuts& cuts) {
  CellComplex complex;
  auto chunks = make_chunks(grid, cuts);
  make_copies(grid, chunks, complex);
  make_corners(grid, chunks, complex);
  return complex;
}

ComplexChange update_complex(const Grid& grid, const Cuts& cuts, const std::span<const EdgeId> new_edges,
                             CellComplex& complex) {
  return Update(grid, cuts, complex).run(new_edges);
}

Pieces pieces(const CellComplex& complex) {
  // Copies around a material node that hold it are glued: the cells around it are all there.
  UnionFind corners(complex.n_corners());
  const auto first_real = [](const Copy& copy) { return copy.corners[std::countr_zero(copy.nodes)].value; };
  for (const Copy& copy : complex.copies)
    for (int v = 0; v < 8; ++v)
      if (copy.nodes >> v & 1)
        corners.unite(first_real(copy), copy.corners[v].value);
  Pieces result;
  Table<CornerId, std::uint32_t> number(complex.n_corners(), none);
  result.piece.reserve(complex.n_copies());
  for (const Copy& copy : complex.copies) {
    std::uint32_t& piece = number[CornerId(corners.root(first_real(copy)))];
    if (piece == none)
      piece = result.n_pieces++;
    result.piece.push_back(piece);
  }
  return result;
}

Points rest_positions(const Grid& grid, const CellComplex& complex) {
  Points x;
  x.reserve(with_room(complex.n_corners()));
  for (const NodeId n : complex.node)
    x.push_back(grid.position(n));
  return x;
}

} // namespace kerf::grid
