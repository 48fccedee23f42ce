#include "grid/complex.h"

#include "base/loan.h"
#include "base/parallel.h"
#include "base/sort_unique.h"
#include "grid/corner_classes.h"
#include "grid/cube.h"
#include "grid/fronts.h"
#include "grid/solid.h"
#include "grid/touched.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <stdexcept>

namespace kerf::grid {

namespace {

constexpr std::uint32_t none = Id<void>::no_value;

struct CutCell {
  CellId cell;
  Parts parts;
};

/// The cells with a cut edge, or with a front, ascending.
std::vector<CutCell> find_cut_cells(const Solid& solid) {
  std::vector<CutCell> cells;
  for (const TouchedCell& touched : touched_cells(solid.grid, solid.cuts)) // by which lines is its configuration
    if (solid.cuts.front(touched.cell) == nullptr)
      cells.push_back({touched.cell, parts_of(cuts_of(solid, touched.cell, touched.lines))});
  for (const Front& front : solid.cuts.fronts())
    cells.push_back({front.cell, parts_of(cuts_of_copies(solid, front.cell))});
  std::ranges::sort(cells, {}, &CutCell::cell);
  return cells;
}

void make_copies(const Grid& grid, const std::vector<CutCell>& cut_cells, CellComplex& complex) {
  std::size_t n_copies = grid.n_cells();
  for (const CutCell& cut : cut_cells)
    n_copies += cut.parts.n - 1;
  complex.copies.reserve(with_slack(n_copies));
  complex.first_copy.reserve(grid.n_cells());
  auto cut = cut_cells.begin();
  for (const CellId c : ids<CellId>(grid.n_cells())) {
    complex.first_copy.push_back(CopyId(complex.n_copies()));
    if (cut == cut_cells.end() || cut->cell != c) {
      complex.copies.push_back({.cell = c, .nodes = 0xff, .corners = {}, .next = {}});
      continue;
    }
    for (const Part& part : cut->parts) {
      const bool is_last = &part + 1 == cut->parts.end();
      complex.copies.push_back(
        {c, part.nodes, part.skin, {}, is_last ? CopyId() : CopyId(complex.n_copies() + 1), part.intervals});
    }
    ++cut;
  }
}

/// The nodes that may have another corner than their real one, and cut cells around them, as lists through slots (cell,
/// vertex): empty nodes with all their cells, and material nodes with those cells that have several copies. Around any
/// other node every copy holds it, and all are glued.
class SlotsOfNodes {
 public:
  SlotsOfNodes(const Grid& grid, const std::vector<CutCell>& cut_cells) : first_(grid.n_nodes(), none) {
    slots_.reserve(4 * cut_cells.size());
    for (const CutCell& cut : cut_cells) {
      const auto nodes = grid.nodes(cut.cell);
      for (std::uint8_t v = 0; v < 8; ++v)
        if (cut.parts.n > 1 || !grid.is_material(nodes[v])) {
          slots_.push_back({cut.cell, v, first_[nodes[v]]});
          first_[nodes[v]] = static_cast<std::uint32_t>(slots_.size() - 1);
        }
    }
  }

  bool has(const NodeId node) const { return first_[node] != none; }
  CellsAround cells_around(const Grid& grid, const NodeId node) const {
    CellsAround cells;
    for (std::uint32_t i = first_[node]; i != none; i = slots_[i].next)
      cells.add(slots_[i].cell, slots_[i].vertex);
    if (grid.is_material(node))
      cells.complete(grid);
    return cells;
  }

 private:
  struct Slot {
    CellId cell;
    std::uint8_t vertex;
    std::uint32_t next;
  };
  Table<NodeId, std::uint32_t> first_;
  std::vector<Slot> slots_;
};

/// Numbers the corners by node, and enters them in the copies around nodes that have slots.
void number_corners(const Solid& solid, const SlotsOfNodes& slots, CellComplex& complex) {
  const Grid& grid = solid.grid;
  complex.node.reserve(with_slack(grid.n_nodes()));
  complex.real_corner.resize(grid.n_nodes());
  for (const NodeId node : ids<NodeId>(grid.n_nodes())) {
    if (!slots.has(node)) {
      complex.real_corner[node] = complex.node.push_back(node);
      continue;
    }
    const CornerClasses classes(solid, complex, slots.cells_around(solid.grid, node));
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
}

void make_corners(const Solid& solid, const std::vector<CutCell>& cut_cells, CellComplex& complex) {
  constexpr std::size_t worth = 4096;
  const Grid& grid = solid.grid;
  number_corners(solid, SlotsOfNodes(grid, cut_cells), complex);
  parallel_for(
    complex.n_copies(),
    [&](const std::size_t c) {
      Copy& copy = complex.copies[CopyId(c)];
      const auto nodes = grid.nodes(copy.cell);
      for (int v = 0; v < 8; ++v)
        if (copy.nodes >> v & 1)
          copy.corners[v] = complex.real_corner[nodes[v]];
    },
    worth);
}

/// Splits copies and renames corners around new cut edges.
class Update {
 public:
  explicit Update(Solid& solid) : solid_(solid) {
    change_.n_copies_before = solid.complex.n_copies();
    change_.n_corners_before = solid.complex.n_corners();
  }

  CutChange run(std::vector<EdgeId> new_edges, std::vector<SkinSegment> new_segments,
                const std::span<const CellId> with_other_fronts) {
    change_.edges = std::move(new_edges);
    change_.segments = std::move(new_segments);
    change_.cells = touched_cells(solid_.grid, change_.edges, change_.segments);
    change_.cells.insert(change_.cells.end(), with_other_fronts.begin(), with_other_fronts.end());
    sort_unique(change_.cells);
    std::vector<CellId> may_join(with_other_fronts.begin(), with_other_fronts.end());
    std::ranges::sort(may_join);
    for (const CellId cell : change_.cells)
      divide(cell, may_join);
    std::sort(slots_.begin(), slots_.end());
    for (auto slot = slots_.begin(); slot != slots_.end();) {
      const NodeId node = slot->node;
      CellsAround cells;
      for (; slot != slots_.end() && slot->node == node; ++slot)
        cells.add(slot->cell, slot->vertex);
      cells.complete(solid_.grid);
      rename(node, CornerClasses(solid_, solid_.complex, cells));
    }
    lapse();
    sort_unique(change_.copies);
    change_.reshaped = change_.copies;
    for (const CellId cell : change_.cells)
      for (const CopyId c : solid_.complex.copies_of(cell))
        change_.reshaped.push_back(c);
    sort_unique(change_.reshaped);
    return std::move(change_);
  }

 private:
  struct Slot {
    NodeId node;
    int vertex;
    CellId cell;
    auto operator<=>(const Slot&) const = default;
  };

  void add_slots(const CellId cell) {
    const auto nodes = solid_.grid.nodes(cell);
    for (int v = 0; v < 8; ++v)
      slots_.push_back({nodes[v], v, cell});
  }

  /// A copy before its cell is divided.
  struct Was {
    CopyId copy;
    Items items;
    std::uint32_t crumb;
  };

  /// A part goes on as the copy that had its lowest item, or starts with that one's corners where a lower part goes on
  /// as it. Where a front is taken back, or others hang together, parts may join what copies were: those that no part
  /// goes on as lapse.
  void divide(const CellId cell, const std::span<const CellId> may_join) {
    const CellCuts cell_cuts = cuts_of_copies(solid_, cell);
    const Parts parts = parts_of(cell_cuts), unsaid = unsaid_parts(cell, cell_cuts);
    Table<CopyId, Copy>& copies = solid_.complex.copies;
    std::array<Was, skeleton::n_items> room;
    std::size_t n_before = 0;
    for (const CopyId c : solid_.complex.copies_of(cell))
      room[n_before++] = {c, whole(c, unsaid).items(), solid_.crumbs.of(c)};
    const std::span<const Was> before = std::span(room).first(n_before);
    std::array<CopyId, skeleton::n_items> now;
    bool is_glued_anew = false;
    for (const Was& was : before) {
      bool is_taken = false;
      for (int i = 0; i < parts.n; ++i) {
        const Part& part = parts.items[i];
        if ((part.items() & -part.items() & was.items) == 0)
          continue;
        if ((part.items() & ~was.items) != 0 && !std::ranges::binary_search(may_join, cell))
          throw std::logic_error("a cut has joined what was parted");
        is_glued_anew |= part != copies[was.copy].part();
        if (is_taken)
          change_.copies.push_back(was.copy);
        now[i] = is_taken ? copies.push_back(Copy(copies[was.copy])) : was.copy;
        if (part != copies[now[i]].part())
          set_part(now[i], part);
        solid_.crumbs.set(now[i], crumb_of(part, before));
        is_taken = true;
      }
    }
    solid_.complex.first_copy[cell] = now[0];
    for (int i = 0; i < parts.n; ++i)
      copies[now[i]].next = i + 1 < parts.n ? now[i + 1] : CopyId();
    for (const Was& was : before)
      if (const auto end = now.begin() + parts.n; std::find(now.begin(), end, was.copy) == end) {
        const auto heir = std::find_if(now.begin(), end, [&](const CopyId c) { return copies[c].items() & was.items; });
        lapsing_.push_back({was.copy, heir == end ? now[0] : *heir});
      }
    if (is_glued_anew)
      add_slots(cell);
  }

  /// The crumb that all of a part comes from.
  static std::uint32_t crumb_of(const Part& part, const std::span<const Was> before) {
    std::optional<std::uint32_t> crumb;
    for (const Was& was : before)
      if ((was.items & part.items()) != 0)
        crumb = !crumb || *crumb == was.crumb ? was.crumb : Crumbs::none;
    return *crumb;
  }

  /// Where blades have cut at the skin of a cell for the first time, what its copies were, points of the skin included;
  /// else none.
  Parts unsaid_parts(const CellId cell, const CellCuts& cell_cuts) const {
    if (!cell_cuts.is_cut_at_skin())
      return {};
    for (const CopyId c : solid_.complex.copies_of(cell))
      if (solid_.complex.copies[c].skin != 0)
        return {};
    return whole_parts_of({cell_cuts.material, cell_cuts.cut, 0});
  }

  /// What a copy is of, as unsaid_parts() have it.
  Part whole(const CopyId c, const Parts& unsaid) const {
    const Copy& copy = solid_.complex.copies[c];
    const auto found = std::ranges::find_if(unsaid, [&](const Part& part) { return (part.nodes & copy.nodes) != 0; });
    return found == unsaid.end() ? copy.part() : *found;
  }

  void set_part(const CopyId c, const Part& part) {
    solid_.complex.copies[c].nodes = part.nodes;
    solid_.complex.copies[c].skin = part.skin;
    solid_.complex.copies[c].intervals = part.intervals;
    change_.copies.push_back(c);
  }

  void rename(const NodeId node, const CornerClasses& classes) {
    std::array<CornerId, CornerClasses::max_slots> corner_of;
    for (int k = 0; k < classes.n_classes(); ++k)
      corner_of[k] = CornerId();
    // The first of the classes that come from one corner keeps it. The node's own material is in the first of all: a
    // slot of the cell whose lowest node this is.
    for (const auto& slot : classes.slots())
      if (CornerId& corner = corner_of[slot.class_number]; !corner.valid()) {
        const CornerId old = solid_.complex.copies[slot.copy].corners[slot.vertex];
        const auto end = corner_of.begin() + classes.n_classes();
        corner = std::find(corner_of.begin(), end, old) == end ? old : new_corner(node, old);
      }
    for (const auto& slot : classes.slots())
      note_lapse(solid_.complex.copies[slot.copy].corners[slot.vertex], corner_of[slot.class_number],
                 std::span(corner_of).first(static_cast<std::size_t>(classes.n_classes())));
    for (const auto& slot : classes.slots())
      if (CornerId& corner = solid_.complex.copies[slot.copy].corners[slot.vertex];
          corner != corner_of[slot.class_number]) {
        corner = corner_of[slot.class_number];
        change_.copies.push_back(slot.copy);
      }
  }

  CornerId new_corner(const NodeId node, const CornerId parent) {
    change_.parents.push_back(parent);
    return solid_.complex.node.push_back(node);
  }

  void note_lapse(const CornerId corner, const CornerId heir, const std::span<const CornerId> at_node) {
    const auto is_known = [&] {
      return std::ranges::find(change_.lapsed, corner, &Lapse::corner) != change_.lapsed.end();
    };
    if (std::ranges::find(at_node, corner) == at_node.end() && !is_known())
      change_.lapsed.push_back({corner, heir});
  }

  std::vector<CornerId> corners_at(const CellId cell, const int vertex) const {
    CellsAround around;
    around.add(cell, vertex);
    around.complete(solid_.grid);
    std::vector<CornerId> corners;
    for (int v = 0; v < 8; ++v)
      if (around.at(v).valid())
        for (const CopyId c : solid_.complex.copies_of(around.at(v)))
          corners.push_back(solid_.complex.copies[c].corners[v]);
    return corners;
  }

  /// A lapsed copy stands at a real corner, which never lapses.
  void lapse() {
    for (const auto& [c, heir] : lapsing_) {
      Copy& copy = solid_.complex.copies[c];
      for (int v = 0; v < 8; ++v)
        note_lapse(copy.corners[v], solid_.complex.copies[heir].corners[v], corners_at(copy.cell, v));
      const int lowest = std::countr_zero(solid_.complex.copies[solid_.complex.first_copy[copy.cell]].nodes);
      copy.corners.fill(solid_.complex.real_corner[solid_.grid.nodes(copy.cell)[lowest]]);
      copy.next = CopyId();
      set_part(c, {});
      solid_.crumbs.set(c, Crumbs::lapsed);
    }
    for (const Lapse& now : change_.lapsed)
      for (Lapse& earlier : solid_.complex.lapsed)
        if (earlier.heir == now.corner)
          earlier.heir = now.heir;
    solid_.complex.lapsed.insert(solid_.complex.lapsed.end(), change_.lapsed.begin(), change_.lapsed.end());
  }

  struct Lapsing {
    CopyId copy, heir;
  };

  Solid& solid_;
  CutChange change_;
  std::vector<Slot> slots_; // of the cells that split
  std::vector<Lapsing> lapsing_;
};

} // namespace

CopyId CellComplex::copy_at(const CellId cell, const int vertex) const {
  for (CopyId c = first_copy[cell]; c.valid(); c = copies[c].next)
    if (copies[c].nodes >> vertex & 1)
      return c;
  return {};
}

CopyId CellComplex::copy_with(const CellId cell, const int item) const {
  for (CopyId c = first_copy[cell]; c.valid(); c = copies[c].next)
    if (copies[c].items() >> item & 1)
      return c;
  return {};
}

std::size_t CellComplex::n_bytes() const {
  return copies.items().capacity() * sizeof(Copy) + first_copy.items().capacity() * sizeof(CopyId) +
         node.items().capacity() * sizeof(NodeId) + real_corner.items().capacity() * sizeof(CornerId);
}

CellComplex build_complex(const Solid& solid) {
  CellComplex complex;
  const auto cut_cells = find_cut_cells(solid);
  make_copies(solid.grid, cut_cells, complex);
  make_corners(solid, cut_cells, complex);
  std::vector<CellId> with_fronts;
  for (const Front& front : solid.cuts.fronts())
    with_fronts.push_back(front.cell);
  std::ranges::sort(with_fronts);
  complex.tied = tied_copies(solid, complex, with_fronts);
  return complex;
}

CutChange update_complex(Solid& solid, std::vector<EdgeId> new_edges, std::vector<SkinSegment> new_segments,
                         const std::span<const CellId> with_other_fronts) {
  CutChange change = Update(solid).run(std::move(new_edges), std::move(new_segments), with_other_fronts);
  std::vector<CellId> cells = change.cells; // and those whose copies were tied before: all others are as they were
  for (const auto& [c, d] : solid.complex.tied)
    cells.push_back(solid.complex.copies[c].cell);
  sort_unique(cells);
  solid.complex.tied = tied_copies(solid, solid.complex, cells);
  return change;
}

Points rest_positions(const Solid& solid) {
  Points x;
  x.reserve(with_slack(solid.complex.n_corners()));
  for (const NodeId n : solid.complex.node)
    x.push_back(solid.grid.position(n));
  return x;
}

} // namespace kerf::grid
