#pragma once

/// A body of the scene: its grid, what cuts it, its physics, and how all of it follows a cut.

#include "base/timer.h"
#include "cut/blade.h"
#include "cut/cut_surface.h"
#include "cut/edge_boxes.h"
#include "cut/passed.h"
#include "cut/pending.h"
#include "dynamics/model.h"
#include "dynamics/stepper.h"
#include "geometry/triangle_mesh.h"
#include "grid/complex.h"
#include "surface/placement.h"
#include "surface/surface.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace kerf::scene {

struct Physics {
  std::unique_ptr<dynamics::ElasticModel> model;
  std::unique_ptr<dynamics::Stepper> stepper;
};

/// A part of the rest configuration that is held or moved.
struct SupportRegion {
  Box box;                                       ///< rest configuration, world frame [m]
  std::function<Vec3(double time)> displacement; ///< [m]
};

/// What only a body in a scene that cuts needs.
struct Cutting {
  cut::PendingCuts pending;
  surface::SurfaceIndex surface_index;
  std::optional<cut::EdgeBoxes> boxes;  ///< around the edges; there from start() on
  std::vector<cut::PassedCells> passed; ///< by label, from 1
  Points x_before;                      ///< where the corners were when the blades were met last [m]
  std::vector<std::size_t> n_cut_edges; ///< by label, from 1: the blades, then the cut surfaces
  std::size_t n_double_crossings = 0;   ///< edges that one cut crossed an even number of times: left uncut
};

struct Body {
  std::string name;
  grid::Grid grid;
  grid::Cuts cuts;
  grid::CellComplex complex = {};
  surface::Placement placement = {};
  surface::PlacementCounts placed = {};
  surface::Surface surface = {};
  Points positions = {}; ///< of the surface's vertices, now [m]

  std::function<Physics(const Body&)> make_physics = {};
  Physics physics = {};
  dynamics::State state = {};
  dynamics::Loads loads = {};
  dynamics::StepReport report = {}; ///< of the last step
  std::vector<SupportRegion> regions = {};

  std::unique_ptr<Cutting> cutting = nullptr; ///< null in a scene that cuts nothing
  int n_recuts = 0;                           ///< how often the complex has changed
  double mesh_volume = 0;                     ///< of the input mesh [m^3]
  double first_volume = 0;                    ///< rest volume of the surface before any cut [m^3]
  std::size_t n_lost_shells = 0;              ///< shells of the input mesh that hold no grid node
  std::size_t n_thin_walls = 0;               ///< grid edges through walls of the input mesh that are lost
  std::size_t n_thin_gaps = 0;                ///< grid edges through gaps of the input mesh that are filled
  std::size_t n_triple_crossings = 0;         ///< grid edges of the skin that the input mesh crosses 3, 5, ... times
};

/// Builds complex, surface, state at rest, supports and physics of a body whose grid and skin are there, cut from
/// `mesh`.
void start(Body& body, const geometry::TriangleMesh& mesh, Timings& timings);

/// Cuts the body with what the blades sweep between two times, as it stands now, and carries the state
/// over: new corners take position and velocity from the copy they came from.
void recut(Body& body, std::span<const cut::Blade> blades, double t0, double t1, Timings& timings);

/// Cuts the body with a surface, all of it at once, as it stands now; else like recut().
void cut_at_once(Body& body, const cut::CutSurface& surface, Timings& timings);

/// Moves the surface to the corners.
void follow(Body& body);

} // namespace kerf::scene
