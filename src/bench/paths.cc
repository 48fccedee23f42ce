#include "bench/paths.h"

#include "base/error.h"
#include "base/interrupt.h"
#include "dynamics/constraints.h"
#include "dynamics/preconditioner.h"
#include "dynamics/state.h"
#include "scene/compose.h"
#include "scene/run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <sstream>

namespace kerf::bench {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// What one call of a path takes, as far as it can be counted.
struct Need {
  double flops = unknown, bytes = unknown;
};

/// A cube of 1 m with n nodes across in n + 1 cells, the outer ones half full, that hangs from its upper side; and what
/// else there is in the body and in the scene.
std::string cube_scene(const int n, const double dt, const int n_steps, const std::string& body,
                       const std::string& beside = "") {
  std::ostringstream text;
  text << "subsection Time\n set Time step [s] = " << dt << "\n set End time [s] = " << dt * n_steps << "\nend\n"
       << "subsection Gravity\n set Acceleration [m/s^2] = 0, 0, -1\nend\n"
       << "subsection Body cube\n set Shape = box\n set Sides [m] = 1, 1, 1\n set Cube edge [m] = " << 1.0 / n
       << "\n subsection Material\n  set Density [kg/m^3] = 1000\n  set Young's modulus [Pa] = 1e5\n"
       << "  set Poisson's ratio [1] = 0.3\n end\n subsection Support roof\n  set Lower [m] = -1, -1, " << 0.5 - 1.3 / n
       << "\n  set Upper [m] = 1, 1, 1\n end\n"
       << body << "end\n"
       << beside;
  return text.str();
}

std::unique_ptr<scene::World> world_of(const std::string& text) {
  return std::make_unique<scene::World>(scene::compose(scene::scan_scene_text(text, "a benchmark's scene", {})));
}

/// Explicit steps that the smallest pieces of a cut cell bear: sound crosses a cube in 20 of them.
double explicit_step(const int n) { return 0.05 / n / std::sqrt(1e5 / 1000); }

/// A path at one size, ready to be called again and again.
struct Ready {
  std::size_t n_items;
  std::function<void()> call;
  Need need = {};
};
/// Or measured by itself, as a cut that can be made once.
struct Measured {
  std::size_t n_items;
  Sample sample;
};

/// A kind of body, and the paths that are measured on it.
struct Path {
  std::string name, item;
  std::function<Ready(scene::World& world)> on; ///< one of these two
  std::function<Measured(int n, const Options& options)> by_itself;
};
struct Group {
  std::function<std::string(int n)> scene;
  double largest; ///< cells from which on it takes too long
  std::vector<Path> paths;
};

dynamics::ElasticModel& model_of(scene::World& world) {
  return dynamic_cast<dynamics::ElasticModel&>(world.bodies[0].physics->model());
}

/// Positions off rest by a hundredth of a cube.
Points stirred(const Points& rest, const double h, const double phase = 1) {
  Points x = rest;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      x[i][axis] += 0.01 * h * std::sin(phase + 7.0 * double(i) + 3.0 * axis);
  return x;
}

/// One of two such positions after the other: a model may know its answer for the one it met last.
class Stirred {
 public:
  Stirred(const scene::Body& body, const double first) {
    for (const double phase : {first, first + 1})
      positions_.push_back(stirred(body.physics->rest(), body.solid.grid.h(), phase));
  }
  const Points& next() { return positions_[n_++ % 2]; }

 private:
  std::vector<Points> positions_;
  std::size_t n_ = 0;
};

/// Of full cubes, counted from kernels.h: two transforms of 72 additions, two rotations of seven modes (15 each),
/// Hooke's law; of rows read, read and written, corners' numbers and a rotation.
Need need_of_product(const std::size_t n_elements) {
  constexpr double flops = 2 * 72 + 2 * 7 * 15 + 60, bytes = 3 * 32 + 8 * 4 + 9 * 4;
  return {flops * double(n_elements), bytes * double(n_elements)};
}

/// The equation of an implicit step of a second: stiff enough for multigrid whatever the cubes.
struct StepEquation {
  StepEquation(dynamics::ElasticModel& of, const scene::Body& body)
    : model(of), constraints(body.loads, body.state.x.size()) {
    model.linearise(body.state.x);
    model.stiffness_diagonal([this](std::size_t, const Mat3& block) { trace += block.trace(); });
  }
  dynamics::Preconditioner* preconditioner() const {
    return model.preconditioner({1, 1, model.lumped_mass(), trace, loads, constraints});
  }

  dynamics::ElasticModel& model;
  dynamics::Constraints constraints;
  dynamics::LoadTangent loads = {};
  double trace = 0;
};

std::vector<Path> paths_of_elements() {
  const auto on_elements = [](const auto& make) {
    return [make](scene::World& world) {
      scene::Body& body = world.bodies[0];
      return make(model_of(world), body, body.solid.complex.n_copies());
    };
  };
  using dynamics::ElasticModel;
  const auto moved = [](const scene::Body& body) {
    return std::make_shared<Points>(stirred(body.physics->rest(), body.solid.grid.h()));
  };
  return {{"linearisation, elements",
           "elements",
           on_elements([moved](ElasticModel& model, scene::Body& body, std::size_t n) {
             return Ready{n, [&model, x = moved(body)] { model.linearise(*x); }};
           }),
           {}},
          {"stiffness product, elements",
           "elements",
           on_elements([moved](ElasticModel& model, scene::Body& body, std::size_t n) {
             const auto x = moved(body), y = std::make_shared<Points>(x->size());
             model.linearise(*x);
             return Ready{n, [&model, x, y] { model.apply_stiffness(dynamics::flat(*x), dynamics::flat(*y)); },
                          need_of_product(n)};
           }),
           {}},
          {"forces, elements",
           "elements",
           on_elements([moved](ElasticModel& model, scene::Body& body, std::size_t n) {
             const auto x = std::make_shared<Stirred>(body, 1);
             const auto f = std::make_shared<Points>();
             return Ready{n, [&model, x, f] { model.force(x->next(), *f); }};
           }),
           {}},
          {"energy, elements",
           "elements",
           on_elements([moved](ElasticModel& model, scene::Body& body, std::size_t n) {
             return Ready{n, [&model, x = std::make_shared<Stirred>(body, 3)] { model.energy(x->next()); }};
           }),
           {}},
          {"surface follows",
           "vertices",
           [](scene::World& world) {
             scene::Body& body = world.bodies[0];
             const double bytes =
               24.0 * double(body.surface.rest.size()) + 36.0 * double(body.surface.weights.values.size());
             return Ready{body.surface.rest.size(),
                          [&body] {
                            scene::follow(body);
                            scene::positions(body);
                          },
                          {unknown, bytes}};
           },
           {}},
          {"multigrid takes an equation",
           "elements",
           on_elements([](ElasticModel& model, scene::Body& body, std::size_t n) {
             const auto step = std::make_shared<StepEquation>(model, body);
             return Ready{n, [step] { step->preconditioner(); }};
           }),
           {}},
          {"multigrid's cycle",
           "elements",
           on_elements([moved](ElasticModel& model, scene::Body& body, std::size_t n) {
             const auto step = std::make_shared<StepEquation>(model, body);
             const auto r = moved(body), z = std::make_shared<Points>(r->size());
             return Ready{n, [step, of_step = step->preconditioner(), r, z] {
                            of_step->apply(dynamics::flat(*r), dynamics::flat(*z));
                          }};
           }),
           {}},
          {"implicit step, elements",
           "elements",
           on_elements([](ElasticModel&, scene::Body& body, std::size_t n) {
             return Ready{n, [&body] { body.physics->step(body.state, body.loads, 1.0 / 60); }};
           }),
           {}}};
}

/// A step of the body's own integrator.
Path step_path(const std::string& name, const std::string& item, const std::function<double(int)>& dt) {
  return {name,
          item,
          [=](scene::World& world) {
            scene::Body& body = world.bodies[0];
            const int n = static_cast<int>(std::lround(1 / body.solid.grid.h()));
            return Ready{body.state.x.size(), [&body, dt = dt(n)] { body.physics->step(body.state, body.loads, dt); }};
          },
          {}};
}

/// Composing a body: reading its mesh into the grid, copies, surface, physics.
Measured composing(const int n, const Options& options) {
  std::size_t n_cells = 0;
  const Sample sample =
    timed([&] { n_cells = world_of(cube_scene(n, 1.0 / 60, 1, ""))->bodies[0].solid.grid.n_cells(); },
          std::min(options.n_samples, 5), options.least);
  return {n_cells, sample};
}

/// A blade on its way through the body: everything that follows a cut, by edges that are cut.
Measured cutting(const int n, const Options& options) {
  constexpr int n_steps = 10;
  std::ostringstream blade;
  blade << "subsection Blade knife\n set Edge [m] = 0, -1, 0; 0, 1, 0\n set Times [s] = 0, " << n_steps / 60.0
        << "\n set Positions [m] = 0.013, 0, 0.6; 0.031, 0, -0.6\nend\nsubsection Observables\n set Names = cut "
           "edges\nend\n";
  const std::string text = cube_scene(n, 1.0 / 60, n_steps, "", blade.str());
  std::vector<double> seconds;
  double n_edges = 0;
  for (int i = 0; i < std::min(options.n_samples, 3); ++i) {
    const auto world = world_of(text);
    Timings stages;
    for (int step = 1; step <= n_steps; ++step)
      scene::advance(*world, step, stages);
    n_edges = world->bodies[0].observables[0].value(world->bodies[0]);
    seconds.push_back(stages["cut"] + stages["topology"] + stages["assemble"]);
  }
  return {static_cast<std::size_t>(n_edges), sample_of(seconds)};
}

const std::vector<Group>& groups() {
  constexpr double few = 5.1e4, all = 1e9;
  const auto scene = [](const std::string& body) {
    return [=](const int n) { return cube_scene(n, 1.0 / 60, 1, body); };
  };
  const auto explicit_scene = [](const std::string& body) {
    return
      [=](const int n) { return cube_scene(n, explicit_step(n), 1, body + " set Integrator = symplectic Euler\n"); };
  };
  static const std::vector<Group> list = {
    {scene(""), all, paths_of_elements()},
    {explicit_scene(""), all, {step_path("explicit step, elements", "corners", explicit_step)}},
    {explicit_scene(" set Backend = mass-spring\n"),
     all,
     {step_path("explicit step, springs", "corners", explicit_step)}},
    {explicit_scene(" set Backend = pba\n"), few, {step_path("explicit step, points", "phyxels", explicit_step)}},
    {scene(" set Backend = lattice\n subsection Lattice\n  set Alpha [1] = 0.5\n end\n"),
     all,
     {step_path("shape matching step", "corners", [](int) { return 1.0 / 60; })}},
    {nullptr,
     all,
     {{"composing a body", "cells", {}, composing}, {"cutting, with all that follows", "edges", {}, cutting}}}};
  return list;
}

output::BenchRow row_of(const Path& path, const int n, const std::size_t n_items, const Sample& sample,
                        const Need& need, const Machine& machine) {
  const double t = sample.median;
  return {path.name,
          path.item,
          std::int64_t(n + 1) * (n + 1) * (n + 1),
          static_cast<std::int64_t>(n_items),
          t,
          sample.spread,
          t > 0 ? double(n_items) / t : 0,
          need.flops / t / machine.flops,
          need.bytes / t / machine.bandwidth};
}

/// Nodes across, so that each body has about three times the cells of the one before.
constexpr std::array sizes = {5, 8, 12, 17, 25, 36, 45, 65, 99};

} // namespace

std::vector<std::string> names_of_paths() {
  std::vector<std::string> names;
  for (const Group& group : groups())
    for (const Path& path : group.paths)
      names.push_back(path.name);
  return names;
}

std::vector<output::BenchRow> measure_paths(const Options& options, const Machine& machine,
                                            const std::function<void(const output::BenchRow&)>& say) {
  const auto is_wanted = [&](const Path& path) { return path.name.find(options.only) != std::string::npos; };
  std::vector<output::BenchRow> rows;
  for (const Group& group : groups()) {
    if (std::none_of(group.paths.begin(), group.paths.end(), is_wanted))
      continue;
    for (const int n : sizes) {
      if (std::pow(n + 1, 3) > std::min(options.largest, group.largest))
        break;
      if (const int signal = wish_to_end())
        throw Interrupted(signal, ": nothing is written");
      const auto world = group.scene ? world_of(group.scene(n)) : nullptr;
      for (const Path& path : group.paths) {
        if (!is_wanted(path))
          continue;
        if (path.on) {
          const Ready ready = path.on(*world);
          rows.push_back(
            row_of(path, n, ready.n_items, timed(ready.call, options.n_samples, options.least), ready.need, machine));
        } else {
          const Measured measured = path.by_itself(n, options);
          rows.push_back(row_of(path, n, measured.n_items, measured.sample, {}, machine));
        }
        say(rows.back());
      }
    }
  }
  return rows;
}

} // namespace kerf::bench
