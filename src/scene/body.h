#pragma once

/// A body of the scene: its grid, what cuts it, its physics, and how all of it follows a cut.

#include "base/timer.h"
#include "cut/cutter.h"
#include "geometry/triangle_mesh.h"
#include "physics/physics.h"
#include "scene/accounts.h"
#include "scene/crack.h"
#include "scene/interior.h"
#include "scene/region.h"
#include "surface/placement.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace kerf::scene {

/// A part of the rest configuration that is held or moved.
struct SupportRegion {
  std::string name;
  Region region;
  std::function<Vec3(double time)> displacement;  ///< [m]
  std::function<Mat3(double time)> rotation = {}; ///< about the origin; empty: never turned
  Mat3 held = Mat3::Identity();                   ///< dynamics::Support::held
};

/// Displacement from rest [m] and velocity [m/s] of the rest position X [m]; the time is 0.
struct InitialState {
  std::function<Vec3(const Vec3&X, double time)> displacement, velocity;
  double energy = 0; ///< kinetic and elastic, once the body is put there [J]
};

struct Body;
/// Makes loads of what the body is now; asked again after every cut.
struct LoadMaker {
  std::string name;
  std::function<void(const Body&, std::vector<std::unique_ptr<dynamics::Load>>&)> make;
};
using PhysicsMaker = std::function<std::unique_ptr<physics::Physics>(const physics::CutBody&)>;

/// A point of the body whose motion is reported.
struct Probe {
  std::string name;
  Vec3 rest = Vec3::Zero(); ///< [m]
  grid::CopyId copy = {};   ///< whose material it lies in now
};

/// One series of a run.
struct Observable {
  std::string name;   ///< "kinetic energy", "reaction wall x"
  std::string unit;   ///< "J"
  std::string source; ///< formula
  std::function<double(const Body&)> value;
};

struct Body {
  std::string name;
  grid::Solid solid;
  surface::Placement placement = {};
  surface::PlacementCounts placed = {};
  surface::Surface surface = {};
  surface::SurfaceIndex surface_index = {}; ///< nothing in a scene that cuts nothing
  mutable Points positions_ = {};           ///< of its vertices, when somebody asked last: positions()
  mutable bool has_moved = true;            ///< since then

  std::unique_ptr<physics::Physics> physics = nullptr;
  double density = 0;                       ///< of its material [kg/m^3]
  dynamics::State state = {};               ///< of the particles of its physics
  std::optional<InitialState> initial = {}; ///< empty: at rest
  dynamics::Loads loads = {};
  dynamics::StepReport report = {}; ///< of the last step
  int n_modes = 0;                  ///< that the integrator modal finds in each step
  int n_divided = 0;                ///< steps so far that were taken again in substeps
  std::vector<SupportRegion> regions = {};
  std::vector<LoadMaker> load_makers = {};
  std::vector<std::size_t> first_load = {}; ///< of each maker in loads.acting, and their end
  std::vector<std::string> grips = {}; ///< the forceps that hold it now; their supports come after those of its regions

  std::vector<Probe> probes = {};
  std::vector<NamedFront> fronts = {};
  std::vector<Observable> observables = {};
  std::unique_ptr<Accounts> accounts = nullptr; ///< null when no observable needs them

  std::unique_ptr<BodyInterior> interior = nullptr; ///< null in a scene that does not say what is inside

  std::unique_ptr<cut::Cutter> cutter = nullptr; ///< null in a scene that cuts nothing; labels: blades, then surfaces
  int n_recuts = 0;                              ///< how often the complex has changed
  grid::Pieces pieces = {};                      ///< of its copies
  double mesh_volume = 0;                        ///< of the input mesh [m^3]
  double first_volume = 0;                       ///< rest volume of the surface before any cut [m^3]
  std::size_t n_lost_shells = 0;                 ///< shells of the input mesh that hold no grid node
  std::size_t n_thin_walls = 0;                  ///< grid edges through walls of the input mesh that are lost
  std::size_t n_thin_gaps = 0;                   ///< grid edges through gaps of the input mesh that are filled
  std::size_t n_triple_crossings = 0;            ///< grid edges of the skin that the input mesh crosses 3, 5, ... times
};

/// What the physics sees of a body.
inline physics::CutBody seen(const Body& body) { return {body.solid, body.surface, body.density, &body.pieces}; }

/// Where the corners are now [m].
inline const Points& corners(const Body& body) { return body.physics->corners(body.state); }

/// Where the surface's vertices are now [m]: they are moved when somebody asks. By one thread at a time.
const Points& positions(const Body& body);

/// Builds complex, surface, physics, state at rest, supports and loads of a body whose grid and skin are there, cut
/// from `mesh`.
void start(Body& body, const geometry::TriangleMesh& mesh, const PhysicsMaker& make_physics, Timings& timings);

/// Makes supports and loads of what the body is now; those of forceps are made by hold(). After a cut: which one.
void make_loads(Body& body, const grid::CutChange* change = nullptr);
/// Finds the copy whose material each probe lies in; not valid for one outside.
void find_probes(Body& body);

/// All that steps and cuts have made of a body; into one that has just been composed.
void archive(Archive& a, Body& body);

/// Cuts the body with what the blades sweep between two times, as it stands now, and carries the state
/// over as its physics does: new corners take position and velocity from the copy they came from.
void recut(Body& body, std::span<const cut::Blade> blades, double t0, double t1, Timings& timings);

/// Cuts the body with a surface, all of it at once, as it stands now; else like recut().
void cut_at_once(Body& body, const cut::CutSurface& surface, Timings& timings);

/// Moves the corners to where the state is, and the surface when somebody asks for it.
void follow(Body& body);

} // namespace kerf::scene
