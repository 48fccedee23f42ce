#pragma once

/// A body under test: what scene/body.cc keeps of a body, without physics, so that a test can put its corners anywhere.

#include "cut/cutter.h"
#include "surface/placement.h"
#include "surface/surface.h"
#include "tests/fuzz/items.h"
#include "tests/grid/histories.h"
#include "tests/support/bodies.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace kerf::fuzz {

using support::Random;

/// A body as it comes from the mesh, made once and copied by every case.
struct Specimen {
  std::string name;
  support::Body body;
  Items items = items_of(body.grid);
};

/// What the cases met, summed.
struct Tally {
  std::size_t n_cases = 0, n_sweeps = 0, n_idle_sweeps = 0, n_cut_edges = 0, n_releases = 0;
  surface::PlacementCounts placed;
  std::size_t n_double_crossings = 0, n_masses = 0, n_most_pieces = 0, n_most_waiting = 0;
  std::size_t n_thread_pairs = 0, n_below_skin = 0, n_of_skin = 0, n_left_whole = 0;
  double worst_volume = 0;       ///< change of the rest volume, relative to the body [1]
  double worst_disagreement = 0; ///< of a piece's volumes by tetrahedra and by triangles, relative to the body [1]
  double worst_mass = 0;         ///< difference of a corner's mass and that of its heirs, in h^3 [1]
  double worst_cell = 0;         ///< change of the material in one cell, in h^3 [1]
  double least_mass = 1;         ///< of a copy at one of its corners, in h^3 [1]
  double least_fill = 1;         ///< of a copy [1]
  double least_piece = 1;        ///< volume, in h^3 [1]
  std::size_t n_steps = 0;       ///< of blades that leave fronts
  std::size_t n_fronts = 0;      ///< that were begun
  std::size_t n_most_ties = 0;   ///< at a time
};

/// Parts of h^3 in a cell [1].
struct CellVolumes {
  std::array<double, 8> of_octants{}; ///< by vertex
  std::vector<double> of_copies;      ///< in the order of CellComplex::copies_of
  double least_mass = 1;              ///< of a copy at one of its corners

  double sum() const;
  bool operator==(const CellVolumes&) const = default;
};

struct Subject {
  const Specimen& specimen;
  grid::Solid solid;
  surface::Surface surface;
  surface::SurfaceIndex index;
  cut::EdgeBoxes boxes;                      ///< made before any cut
  cut::Cutter cutter;                        ///< knows where the corners were when the blades were met last
  Points x;                                  ///< corners now [m]
  grid::Pieces pieces;
  Table<grid::CellId, CellVolumes> volumes;  ///< now
  Table<grid::CellId, double> first_volumes; ///< before any cut [h^3]
  double volume = 0;                         ///< at rest, before any cut [m^3]

  const grid::Grid& grid() const { return solid.grid; }
};

/// At rest; every invariant is checked (invariants.h).
Subject make_subject(const Specimen& specimen, Tally& tally);

/// Lets the cutter cut, carries the corners over, and checks every invariant. Throws Violation.
void cut(Subject& subject, const std::function<grid::CutChange(Subject&)>& make, Tally& tally);

/// The same with cuts that are known: nothing else is cut.
void cut(Subject& subject, const grid::histories::Step& step, Tally& tally);

/// Adds the bits of positions, cuts, complex and surface to a number.
std::uint64_t digest(const Subject& subject, std::uint64_t start);

} // namespace kerf::fuzz
