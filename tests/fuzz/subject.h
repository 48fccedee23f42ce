#pragma once

/// A body under test: what scene/body.cc keeps of a body, without physics, so that a test can put its corners anywhere.

#include "cut/cut_surface.h"
#include "surface/placement.h"
#include "surface/surface.h"
#include "tests/support/bodies.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace kerf::fuzz {

using support::Random;

/// How well a placed skin keeps mass: vertices slide along planes without any change of shape, on curved skins they
/// keep the volume alone.
enum class Skin { plane, curved };

/// A body as it comes from the mesh, made once and copied by every case.
struct Specimen {
  std::string name;
  support::Body body;
  Skin skin = Skin::curved;
};

/// What the cases met, summed.
struct Tally {
  std::size_t n_cases = 0, n_sweeps = 0, n_idle_sweeps = 0, n_cut_edges = 0, n_releases = 0, n_placed = 0;
  std::size_t n_clamped = 0, n_double_crossings = 0, n_masses = 0, n_most_pieces = 0, n_most_waiting = 0;
  std::size_t n_thread_pairs = 0;
  double worst_volume = 0;       ///< change of the rest volume, relative to the body [1]
  double worst_disagreement = 0; ///< of a piece's volumes by octants and by triangles, relative to the body [1]
  double worst_mass = 0;         ///< difference of a corner's mass and that of its heirs, in h^3 [1]
  double worst_skin_cell = 0;    ///< change of the material in one cell of the skin, in h^3 [1]
};

/// Parts of h^3 that belong to each vertex of a cell [1].
using OctantVolumes = std::array<double, 8>;

struct Subject {
  const Specimen& specimen;
  grid::Cuts cuts;
  grid::CellComplex complex;
  surface::Surface surface;
  surface::SurfaceIndex index;
  cut::EdgeBoxes boxes;                                      ///< made before any cut
  Points x, x_before;                                        ///< corners now, and when the blades were met last [m]
  Table<grid::CellId, OctantVolumes> octants, first_octants; ///< now, and before any cut
  double volume = 0;                                         ///< at rest, before any cut [m^3]

  const grid::Grid& grid() const { return specimen.body.grid; }
};

/// At rest; every invariant is checked (invariants.h).
Subject make_subject(const Specimen& specimen, Tally& tally);

/// Cuts these edges in one step, carries the corners over, and checks every invariant. Throws Violation.
void cut(Subject& subject, std::span<const grid::EdgeCut> cuts, Tally& tally);

/// Adds the bits of positions, cuts, complex and surface to a number.
std::uint64_t digest(const Subject& subject, std::uint64_t start);

} // namespace kerf::fuzz
