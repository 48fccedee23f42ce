#include "tests/fuzz/invariants.h"

#include "grid/cube.h"
#include "grid/fronts.h"
#include "grid/in_use.h"
#include "tests/support/placed.h"
#include "tests/support/same.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <sstream>

namespace kerf::fuzz {

namespace cube = grid::cube;
using grid::CellComplex;
using grid::CellId;
using grid::Copy;
using grid::CopyId;
using grid::CornerId;
using grid::NodeId;

namespace {

constexpr double tolerance = 1e-12; // of the body's volume, and of h^3 for masses
using Labels = std::vector<std::uint32_t>;
using Links = std::vector<std::array<std::uint32_t, 2>>;

[[noreturn]] void complain(const std::string& what) { throw Violation(what); }

std::string number(const double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// Names 0 .. n - 1 by the smallest member of the set that links join them to.
Labels flooded(const std::size_t n, const Links& links) {
  Labels start(n + 1, 0), neighbours(2 * links.size());
  for (const auto& link : links)
    for (const auto end : link)
      ++start[end + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  Labels next(start.begin(), start.end() - 1);
  for (const auto& [a, b] : links) {
    neighbours[next[a]++] = b;
    neighbours[next[b]++] = a;
  }
  constexpr std::uint32_t unseen = Id<void>::no_value;
  Labels label(n, unseen), open;
  for (std::uint32_t seed = 0; seed < n; ++seed) {
    if (label[seed] != unseen)
      continue;
    label[seed] = seed;
    for (open.push_back(seed); !open.empty();) {
      const auto i = open.back();
      open.pop_back();
      for (auto k = start[i]; k < start[i + 1]; ++k)
        if (label[neighbours[k]] == unseen) {
          label[neighbours[k]] = seed;
          open.push_back(neighbours[k]);
        }
    }
  }
  return label;
}

/// Two ways to name the same things must tell the same sets apart. Returns how many sets there are.
std::size_t require_same_sets(const Labels& a, const Labels& b, const std::string& what) {
  constexpr std::uint32_t none = Id<void>::no_value;
  Labels to_b(a.empty() ? 0 : *std::max_element(a.begin(), a.end()) + 1, none);
  Labels to_a(b.empty() ? 0 : *std::max_element(b.begin(), b.end()) + 1, none);
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (to_b[a[i]] == none && to_a[b[i]] == none) {
      to_b[a[i]] = b[i];
      to_a[b[i]] = a[i];
      ++n;
    }
    if (to_b[a[i]] != b[i] || to_a[b[i]] != a[i])
      complain(what);
  }
  return n;
}

/// An item of a cell.
struct Held {
  Item item;
  CopyId copy; ///< by the complex; where that does not tell, by a flood within the cell
};

/// Points of the skin that no copy tells of are with the nodes that they hang on.
void find_untold(std::vector<Held>& held, const ItemLinks& links) {
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (const auto& [a, b] : links) {
      Held &p = *std::ranges::find(held, a, &Held::item), &q = *std::ranges::find(held, b, &Held::item);
      if (p.copy.valid() == q.copy.valid())
        continue;
      (p.copy.valid() ? q : p).copy = p.copy.valid() ? p.copy : q.copy;
      has_grown = true;
    }
  }
}

std::vector<Held> held_by(const Items& items, const grid::Solid& solid, const CellId c) {
  std::vector<Held> all;
  const bool is_told = is_cut_at_skin(solid, items, c);
  bool has_untold = false;
  for (int i = 0; i < grid::skeleton::n_items; ++i) {
    const bool is_item = items.name[c][i] != Items::none, is_node = i < grid::skeleton::first_on_line;
    const CopyId copy = solid.complex.copy_with(c, i);
    if (copy.valid() != (is_item && (is_node || is_told)))
      complain("a copy of cell " + std::to_string(c.value) + " holds an item that is not there, or the reverse");
    if (is_node && solid.complex.copy_at(c, i) != copy)
      complain("a node of cell " + std::to_string(c.value) + " is in two copies");
    if (is_item)
      all.push_back({items.name[c][i], copy});
    has_untold |= is_item && !copy.valid();
  }
  if (has_untold)
    find_untold(all, links(solid, items, c));
  return all;
}

using HeldByCell = Table<CellId, std::vector<Held>>;

HeldByCell all_held(const Items& items, const grid::Solid& solid) {
  HeldByCell held;
  for (const CellId c : ids<CellId>(solid.grid.n_cells()))
    held.push_back(held_by(items, solid, c));
  return held;
}

/// The place of an item among what a cell holds.
std::uint32_t place_of(const std::vector<Held>& held, const Item item) {
  const auto at = std::ranges::find(held, item, &Held::item);
  return static_cast<std::uint32_t>(at - held.begin());
}

void require_sound_copies(const Items& items, const grid::Solid& solid, const HeldByCell& held) {
  std::size_t n_copies = 0;
  for (const CellId c : ids<CellId>(solid.grid.n_cells())) {
    ItemLinks links = fuzz::links(solid, items, c);
    for (auto& link : links)
      link = {place_of(held[c], link[0]), place_of(held[c], link[1])};
    Labels copies;
    for (const Held& one : held[c])
      copies.push_back(one.copy.value);
    n_copies += require_same_sets(flooded(held[c].size(), links), copies,
                                  "the copies of cell " + std::to_string(c.value) + " are not its parts");
  }
  if (n_copies != grid::n_copies_in_use(solid.complex))
    complain("there are copies of nothing");
}

/// The copies without a node's material may hold its real corner all the same: those at a cut's front.
void require_real_corners(const grid::Solid& solid) {
  Table<NodeId, std::uint8_t> is_held(solid.grid.n_nodes(), 0);
  for (const Copy& copy : solid.complex.copies)
    for (int v = 0; v < 8 && !copy.is_lapsed(); ++v) {
      const NodeId node = solid.grid.nodes(copy.cell)[v];
      const bool is_real = (copy.nodes >> v & 1) != 0;
      if (solid.complex.node[copy.corners[v]] != node ||
          (is_real && solid.complex.real_corner[node] != copy.corners[v]))
        complain("node " + std::to_string(node.value) + " has a wrong corner in cell " +
                 std::to_string(copy.cell.value));
      is_held[node] |= is_real ? 1 : 0;
    }
  for (const NodeId node : ids<NodeId>(solid.grid.n_nodes()))
    if ((is_held[node] != 0) != solid.grid.is_material(node) ||
        solid.complex.real_corner[node].valid() != solid.grid.is_material(node))
      complain("node " + std::to_string(node.value) + " has a real corner, but is not material, or the reverse");
}

void require_pieces(const Items& items, const grid::Solid& solid, const HeldByCell& held) {
  const Labels component = flooded(items.n_names, links(solid, items));
  const grid::Pieces pieces = grid::pieces(solid.complex);
  Labels by_items, by_copies;
  for (const auto& of_cell : held)
    for (const auto& [item, copy] : of_cell) {
      by_items.push_back(component[item]);
      by_copies.push_back(pieces.piece[copy]);
    }
  if (require_same_sets(by_items, by_copies, "pieces are not what segments join") != pieces.n_pieces)
    complain("the number of pieces is wrong");
}

/// Item by item: the copies on both sides of a face that hold an item of it are one along the whole face; and where
/// cuts cross those that hold the same interval.
Links glued_slots(const Items& items, const grid::Solid& solid, const HeldByCell& held) {
  Links links;
  for (const CellId below : ids<CellId>(solid.grid.n_cells()))
    for (int axis = 0; axis < 3; ++axis) {
      const CellId above = solid.grid.cells(solid.grid.faces(below)[2 * axis + 1])[1];
      if (!above.valid())
        continue;
      const auto glue = [&](const CopyId a, const CopyId b) {
        for (const int w : cube::face_vertices[2 * axis])
          links.push_back({8 * a.value + (w | 1 << axis), 8 * b.value + w});
      };
      for (const auto& [item, a] : held[below]) {
        const std::size_t at = place_of(held[above], item);
        if (at < held[above].size())
          glue(a, held[above][at].copy);
      }
      for (const auto& [item, other] : links_above(solid, items, below, axis))
        glue(held[below][place_of(held[below], item)].copy, held[above][place_of(held[above], other)].copy);
    }
  return links;
}

void require_gluing(const Items& items, const grid::Solid& solid, const HeldByCell& held) {
  const Labels glued = flooded(8 * solid.complex.n_copies(), glued_slots(items, solid, held));
  Labels slots, corners;
  for (const CopyId c : ids<CopyId>(solid.complex.n_copies()))
    for (int v = 0; v < 8 && !solid.complex.copies[c].is_lapsed(); ++v) {
      slots.push_back(glued[8 * c.value + v]);
      corners.push_back(solid.complex.copies[c].corners[v].value);
    }
  if (require_same_sets(slots, corners, "corners are not what gluing joins") + solid.complex.lapsed.size() !=
      solid.complex.n_corners())
    complain("the number of corners is wrong");
}

/// Adds the mass of a tetrahedron in cell coordinates, by a rule that is exact for trilinear shape functions.
void add_mass(const grid::Tetrahedron& t, std::array<double, 8>& mass) {
  const Vec3 centre = 0.25 * (t[0] + t[1] + t[2] + t[3]);
  const double volume = support::volume(t);
  const auto add = [&](const Vec3& p, const double weight) {
    for (int v = 0; v < 8; ++v)
      mass[v] += weight * (v & 1 ? p[0] : 1 - p[0]) * (v & 2 ? p[1] : 1 - p[1]) * (v & 4 ? p[2] : 1 - p[2]);
  };
  add(centre, -0.8 * volume);
  for (const Vec3& p : t)
    add(centre + (p - centre) / 3, 0.45 * volume);
}

unsigned material_of(const CellComplex& complex, const CellId cell) {
  unsigned material = 0;
  for (const CopyId c : complex.copies_of(cell))
    material |= complex.copies[c].nodes;
  return material;
}

/// For each item of a copy, the copy before that had it; a point of the skin that is new was with a node of its own.
std::vector<CopyId> origins_of(const CellComplex& before, const Copy& copy) {
  const auto& vertex = grid::skeleton_of(material_of(before, copy.cell)).vertex;
  std::vector<CopyId> origins;
  for (int i = 0; i < grid::skeleton::n_items; ++i)
    if (copy.items() >> i & 1) {
      const CopyId origin = before.copy_with(copy.cell, i);
      origins.push_back(origin.valid() ? origin : before.copy_at(copy.cell, vertex[i]));
    }
  return origins;
}

} // namespace

void require_sound_complex(const grid::Solid& solid, const Items& items) {
  for (const grid::Tie& tie : grid::ties(solid)) // one that pushes apart would have energy without end
    if (!(tie.length >= 0))
      complain("copies are tied by " + number(tie.length) + " m");
  const HeldByCell held = all_held(items, solid);
  require_sound_copies(items, solid, held);
  require_real_corners(solid);
  require_pieces(items, solid, held);
  require_gluing(items, solid, held);
}

UnionFind require_sound_parents(const CellComplex& before, const CellComplex& after,
                                const Table<CornerId, CornerId>& parents) {
  UnionFind together(before.n_corners());
  struct Past {
    std::set<CornerId> corners;
    bool is_joined = false; ///< a copy that holds it comes from several, or is glued by an interval
  };
  std::vector<Past> pasts(after.n_corners());
  for (const Copy& copy : after.copies) {
    const auto origins = origins_of(before, copy);
    for (int v = 0; v < cube::n_vertices && !copy.is_lapsed(); ++v) {
      Past& past = pasts[copy.corners[v].value];
      past.is_joined |= copy.intervals != 0;
      for (const CopyId origin : origins) {
        if (!origin.valid())
          complain("a copy of cell " + std::to_string(copy.cell.value) + " comes from nowhere");
        past.corners.insert(before.copies[origin].corners[v]);
        past.is_joined |= origin != origins.front();
      }
      const CornerId parent = parents[copy.corners[v]];
      if (before.node[parent] != after.node[copy.corners[v]])
        complain("a corner and its parent are instances of different nodes");
      if ((copy.nodes >> v & 1) && before.real_corner[before.node[parent]] != parent)
        complain("a real corner has a virtual parent");
    }
  }
  for (const CornerId c : ids<CornerId>(after.n_corners()))
    if (const auto& [corners, is_joined] = pasts[c.value];
        !corners.empty() && (!corners.contains(parents[c]) || (corners.size() > 1 && !is_joined)))
      complain("corner " + std::to_string(c.value) + " has several parents");
  for (const auto& [corners, is_joined] : pasts)
    for (const CornerId corner : corners)
      together.unite(corners.begin()->value, corner.value);
  return together;
}

void require_sound_change(const CellComplex& before, const CellComplex& after, const grid::CutChange& change) {
  if (change.n_copies_before != before.n_copies() || change.n_corners_before != before.n_corners() ||
      change.parents.size() != after.n_corners() - before.n_corners())
    complain("a change does not say how large the complex was");
  if (!std::is_sorted(change.copies.begin(), change.copies.end()))
    complain("changed copies are not in order");
  Table<CopyId, std::uint8_t> has_changed(after.n_copies(), 1); // new ones have
  for (const CopyId c : ids<CopyId>(before.n_copies())) {
    const Copy &was = before.copies[c], &is = after.copies[c];
    has_changed[c] =
      was.nodes != is.nodes || was.skin != is.skin || was.intervals != is.intervals || was.corners != is.corners;
  }
  for (std::size_t i = before.n_copies(); i < after.n_copies(); ++i)
    for (const CopyId origin : origins_of(before, after.copies[CopyId(i)]))
      has_changed[origin] = 1; // divided: it may have lost nothing that was named
  for (const CopyId c : ids<CopyId>(after.n_copies()))
    if ((has_changed[c] != 0) != std::binary_search(change.copies.begin(), change.copies.end(), c))
      complain("copy " + std::to_string(c.value) + " has changed, but is not named, or the reverse");
}

void require_closed(const surface::Surface& surface) {
  std::vector<std::uint64_t> forth, back;
  for (const Triangle& triangle : surface.triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint64_t a = triangle[i], b = triangle[(i + 1) % 3];
      if (a == b || std::max(a, b) >= surface.rest.size())
        complain("a triangle holds a vertex twice, or one that is not there");
      forth.push_back(a << 32 | b);
      back.push_back(b << 32 | a);
    }
  std::sort(forth.begin(), forth.end());
  std::sort(back.begin(), back.end());
  if (std::adjacent_find(forth.begin(), forth.end()) != forth.end())
    complain("a directed edge of the surface is met twice");
  if (forth != back)
    complain("the surface is not closed");
}

void require_sound_weights(const grid::Solid& solid, const surface::Surface& surface) {
  const Points corners = grid::rest_positions(solid);
  Points followed;
  surface::follow(surface, corners, followed);
  double reach = solid.grid.h();
  for (const Vec3& p : corners)
    reach = std::max(reach, p.norm());
  for (std::size_t i = 0; i < surface.rest.size(); ++i) {
    double sum = 0;
    for (auto k = surface.weights.start[i]; k < surface.weights.start[i + 1]; ++k)
      sum += surface.weights.values[k];
    if (!(std::abs(sum - 1) < 1e-14))
      complain("a row of W sums to 1 + " + number(sum - 1));
    if (!((followed[i] - surface.rest[i]).norm() < 1e-14 * reach))
      complain("W misses a rest position by " + number((followed[i] - surface.rest[i]).norm()) + " m");
  }
}

double CellVolumes::sum() const { return std::accumulate(of_copies.begin(), of_copies.end(), 0.0); }

CellVolumes require_sound_volumes(const grid::Solid& solid, const CellId cell) {
  CellVolumes volumes;
  for (int v = 0; v < cube::n_vertices; ++v)
    for (const auto& t : grid::octant(solid, cell, v)) {
      const double volume = support::volume(t);
      if (!(volume > 0))
        complain("a tetrahedron of cell " + std::to_string(cell.value) + " has the volume " + number(volume) + " h^3");
      volumes.of_octants[v] += volume;
    }
  for (const CopyId c : solid.complex.copies_of(cell)) {
    std::array<double, 8> mass{};
    grid::for_each_tetrahedron(solid, solid.complex.copies[c],
                               [&](const grid::Tetrahedron& t, int) { add_mass(t, mass); });
    volumes.least_mass = std::min(volumes.least_mass, *std::min_element(mass.begin(), mass.end()));
    volumes.of_copies.push_back(std::accumulate(mass.begin(), mass.end(), 0.0));
  }
  return volumes;
}

void require_material(const Subject& subject, const std::span<const CellId> cells, Tally& tally) {
  for (const CellId cell : cells) {
    const CellVolumes& volumes = subject.volumes[cell];
    tally.least_mass = std::min(tally.least_mass, volumes.least_mass);
    for (const double of_copy : volumes.of_copies)
      tally.least_fill = std::min(tally.least_fill, of_copy);
    if (!(volumes.least_mass > -tolerance))
      complain("a copy of cell " + std::to_string(cell.value) + " has the mass " + number(volumes.least_mass) +
               " h^3 at a corner");
  }
}

void require_kept_volumes(const Subject& subject, Tally& tally) {
  const CellComplex& complex = subject.solid.complex;
  const grid::Pieces pieces = grid::pieces(complex);
  std::vector<double> by_tetrahedra(pieces.n_pieces, 0.0);
  const double cube = std::pow(subject.grid().h(), 3);
  for (const CellId cell : ids<CellId>(subject.grid().n_cells())) {
    std::size_t i = 0;
    for (const CopyId c : complex.copies_of(cell))
      by_tetrahedra[pieces.piece[c]] += cube * subject.volumes[cell].of_copies.at(i++);
  }
  const auto by_triangles = surface::piece_volumes(subject.surface, complex);
  for (std::size_t p = 0; p < by_tetrahedra.size(); ++p) {
    tally.least_piece = std::min(tally.least_piece, by_tetrahedra[p] / cube);
    const double difference = std::abs(by_tetrahedra[p] - by_triangles[p]) / subject.volume;
    tally.worst_disagreement = std::max(tally.worst_disagreement, difference);
    if (!(difference < tolerance))
      complain("piece " + std::to_string(p) + ": volumes by tetrahedra and by triangles differ by " +
               number(difference) + " of the body");
  }
  const double change = std::accumulate(by_tetrahedra.begin(), by_tetrahedra.end(), 0.0) / subject.volume - 1;
  tally.worst_volume = std::max(tally.worst_volume, std::abs(change));
  if (!(std::abs(change) < tolerance))
    complain("the rest volume has changed by " + number(change) + " of the body");
}

void require_same(const CellComplex& a, const CellComplex& b) {
  if (!support::renaming(a, b))
    complain("the complex depends on the order in which edges were cut");
}

Table<CornerId, double> corner_masses(const grid::Solid& solid, const std::span<const CellId> cells) {
  Table<CornerId, double> masses(solid.complex.n_corners(), 0.0);
  for (const CellId cell : cells)
    for (const CopyId c : solid.complex.copies_of(cell)) {
      const Copy& copy = solid.complex.copies[c];
      std::array<double, 8> mass{};
      grid::for_each_tetrahedron(solid, copy, [&](const grid::Tetrahedron& t, int) { add_mass(t, mass); });
      for (int v = 0; v < 8; ++v)
        masses[copy.corners[v]] += mass[v];
    }
  return masses;
}

void require_sound(const Subject& subject, Tally& tally) {
  require_sound_complex(subject.solid, subject.specimen.items);
  require_closed(subject.surface);
  require_sound_weights(subject.solid, subject.surface);
  require_kept_volumes(subject, tally);
}

} // namespace kerf::fuzz
