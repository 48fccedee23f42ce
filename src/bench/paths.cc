#include "bench/path.h"

#include "base/error.h"
#include "base/interrupt.h"
#include "dynamics/constraints.h"
#include "dynamics/preconditioner.h"
#include "dynamics/state.h"
#include "scene/compose.h"
#include "scene/run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <sstream>

namespace kerf::bench {

std::string cube_scene(const int n, const double dt, const int n_steps, const std::string& body,
                       const std::string& beside) {
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

std::unique_ptr<scene::World> world_of(const std::string& text, const std::string& file) {
  return std::make_unique<scene::World>(scene::compose(scene::scan_scene_text(text, file, {})));
}

Points stirred(const Points& rest, const double h, const double phase) {
  Points x = rest;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      x[i][axis] += 0.01 * h * std::sin(phase + 7.0 * double(i) + 3.0 * axis);
  return x;
}

namespace {

/// Explicit steps that the smallest pieces of a cut cell bear: sound crosses a cube in 20 of them.
double explicit_step(const int n) { return 0.05 / n / std::sqrt(1e5 / 1000); }

dynamics::ElasticModel& model_of(scene::World& world) {
  return dynamic_cast<dynamics::ElasticModel&>(world.bodies[0].physics->model());
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

/// What an element of a full cube takes, counted from fem/kernels.h: operations of each part of the loops; of memory
/// the row of one corner, as neighbours share them, the numbers of eight and what is stored by element.
namespace of_element {
constexpr double transform = 72, differences = 21, turn_of_modes = 7 * 15, mean_gradient = 9, law = 60;
constexpr double shape = transform + differences;
/// Halley's iteration takes three steps with strains of a few per cent.
constexpr double rotation = mean_gradient + 32 + 36 + 3 * 27 + 12 + 30 + 90 + 18;
constexpr double spin = 4 * 9 + 9 + 54 + 12;
constexpr double row = 32, numbers = 8 * 4, stored_rotation = 9 * 4;

constexpr Need product = {2 * transform + 2 * turn_of_modes + law, 3 * row + numbers + stored_rotation};
constexpr Need linearisation = {shape + rotation, row + numbers + stored_rotation};
constexpr Need energy = {2 * shape + rotation + turn_of_modes + law + 42, row + numbers};
constexpr Need force = {energy.flops - shape + spin + turn_of_modes + transform, 3 * row + numbers};
/// In single precision, of which two count as one: on the finest level three steps of smoothing before and after and a
/// residual, six products in all, and the same times 2 / 8, 4 / 64, ... below, with twice the steps on each.
constexpr double n_products_of_cycle = 6 / (1 - 0.25);
constexpr Need cycle = {0.5 * n_products_of_cycle * product.flops, 0.5 * n_products_of_cycle * product.bytes};
/// A correction of Newton's method, an iteration of conjugate gradients: its product, cycle, and sums over corners of
/// vectors of three numbers.
constexpr Need iteration = product + cycle + Need{30, 10 * 24};
constexpr Need correction = linearisation + force;
/// Forces, and by corner what moves: of x, v and forces each read and written, and masses.
constexpr Need explicit_step = force + Need{15, 6 * 24 + 8};
/// Three springs along edges and six along diagonals for each cube: 20 operations to tell and to add a force; the
/// volume at its corners.
constexpr Need springs = Need{9 * 20 + 8 * 14, 9 * 3 * 8 + numbers} + Need{15, 6 * 24 + 8};
/// For each corner twelve numbers, and six on the way back, summed over windows along three axes (two additions each),
/// means over eight of its neighbours both ways, and a rotation of Newton's iteration by region.
constexpr Need shape_matching = {3 * 2 * 18 + 2 * 8 * 18 + 330, 3 * 2 * 18 * 8 + 2 * 8 * 12 + 6 * 24};
} // namespace of_element

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
             return Ready{n, [&model, x = moved(body)] { model.linearise(*x); }, double(n) * of_element::linearisation};
           }),
           {}},
          {"stiffness product, elements",
           "elements",
           on_elements([moved](ElasticModel& model, scene::Body& body, std::size_t n) {
             const auto x = moved(body), y = std::make_shared<Points>(x->size());
             model.linearise(*x);
             return Ready{n, [&model, x, y] { model.apply_stiffness(dynamics::flat(*x), dynamics::flat(*y)); },
                          double(n) * of_element::product};
           }),
           {}},
          {"forces, elements",
           "elements",
           on_elements([moved](ElasticModel& model, scene::Body& body, std::size_t n) {
             const auto x = std::make_shared<Stirred>(body, 1);
             const auto f = std::make_shared<Points>();
             return Ready{n, [&model, x, f] { model.force(x->next(), *f); }, double(n) * of_element::force};
           }),
           {}},
          {"energy, elements",
           "elements",
           on_elements([moved](ElasticModel& model, scene::Body& body, std::size_t n) {
             return Ready{n, [&model, x = std::make_shared<Stirred>(body, 3)] { model.energy(x->next()); },
                          double(n) * of_element::energy};
           }),
           {}},
          {"surface follows",
           "vertices",
           [](scene::World& world) {
             scene::Body& body = world.bodies[0];
             const auto n_weights = double(body.surface.weights.values.size());
             const double flops = 6 * n_weights, bytes = 24.0 * double(body.surface.rest.size()) + 36 * n_weights;
             return Ready{body.surface.rest.size(),
                          [&body] {
                            scene::follow(body);
                            scene::positions(body);
                          },
                          {flops, bytes}};
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
                          },
                          double(n) * of_element::cycle};
           }),
           {}},
          {"implicit step, elements",
           "elements",
           on_elements([](ElasticModel&, scene::Body& body, std::size_t n) {
             const auto step = [&body] { return body.physics->step(body.state, body.loads, 1.0 / 60); };
             step();
             const dynamics::StepReport report = step(); // as the first ones come to rest they take fewer
             return Ready{n, step,
                          double(n) * (report.n_iterations * of_element::iteration +
                                       std::max(1, report.n_newton) * of_element::correction)};
           }),
           {}}};
}

/// A step of the body's own integrator, and what it takes for each cube.
Path step_path(const std::string& name, const std::string& item, const std::function<double(int)>& dt,
               const Need& need = {}) {
  return {name,
          item,
          [=](scene::World& world) {
            scene::Body& body = world.bodies[0];
            const int n = static_cast<int>(std::lround(1 / body.solid.grid.h()));
            return Ready{body.state.x.size(), [&body, dt = dt(n)] { body.physics->step(body.state, body.loads, dt); },
                         double(body.solid.complex.n_copies()) * need};
          },
          {}};
}

/// Composing a body: reading its mesh into the grid, copies, surface, physics.
Measured composing(const int n, const Options& options) {
  std::size_t n_cells = 0;
  double bytes = 0; // of what it leaves of the body's shape, which is the least that it writes
  const Sample sample = timed(
    [&] {
      const auto world = world_of(cube_scene(n, 1.0 / 60, 1, ""));
      const grid::Solid& solid = world->bodies[0].solid;
      n_cells = solid.grid.n_cells();
      bytes = double(solid.grid.n_bytes() + solid.cuts.n_bytes() + solid.complex.n_bytes() +
                     world->bodies[0].surface.n_bytes());
    },
    std::min(options.n_samples, 5), options.least);
  return {n_cells, sample, {unknown, bytes}};
}

/// A blade on its way through such a body: these stages of what follows a cut, by edges that are cut.
Measured cutting(const int n, const Options& options, const std::string& body,
                 const std::vector<std::string>& wanted = {"cut", "topology", "assemble", "visibility"}) {
  constexpr int n_steps = 10;
  std::ostringstream blade;
  blade << "subsection Blade knife\n set Edge [m] = 0, -1, 0; 0, 1, 0\n set Times [s] = 0, " << n_steps / 60.0
        << "\n set Positions [m] = 0.013, 0, 0.6; 0.031, 0, -0.6\nend\nsubsection Observables\n set Names = cut "
           "edges\nend\n";
  const std::string text = cube_scene(n, 1.0 / 60, n_steps, body, blade.str());
  std::vector<double> seconds;
  double n_edges = 0;
  for (int i = 0; i < std::min(options.n_samples, 3); ++i) {
    const auto world = world_of(text);
    Timings stages;
    for (int step = 1; step <= n_steps; ++step)
      scene::advance(*world, step, stages);
    n_edges = world->bodies[0].observables[0].value(world->bodies[0]);
    double sum = 0;
    for (const std::string& stage : wanted)
      sum += stages[stage];
    seconds.push_back(sum);
  }
  return {static_cast<std::size_t>(n_edges), sample_of(seconds)};
}

std::vector<Group> find_groups() {
  constexpr double few = 5.1e4, all = 1e9;
  const auto scene = [](const std::string& body) {
    return [=](const int n) { return cube_scene(n, 1.0 / 60, 1, body); };
  };
  const auto explicit_scene = [](const std::string& body) {
    return
      [=](const int n) { return cube_scene(n, explicit_step(n), 1, body + " set Integrator = symplectic Euler\n"); };
  };
  std::vector<Group> list = {
    {scene(""), all, paths_of_elements()},
    {explicit_scene(""),
     all,
     {step_path("explicit step, elements", "corners", explicit_step, of_element::explicit_step)}},
    {explicit_scene(" set Backend = mass-spring\n"),
     all,
     {step_path("explicit step, springs", "corners", explicit_step, of_element::springs)}},
    {explicit_scene(" set Backend = pba\n"), few, {step_path("explicit step, points", "phyxels", explicit_step)}},
    {scene(" set Backend = lattice\n subsection Lattice\n  set Alpha [1] = 0.5\n end\n"),
     all,
     {step_path("shape matching step", "corners", [](int) { return 1.0 / 60; }, of_element::shape_matching)}},
    {scene(" set Backend = lattice\n subsection Lattice\n  set Alpha [1] = 0.5\n  set Half width [cells] = 4\n end\n"),
     all,
     {step_path("shape matching step, half width 4", "corners", [](int) { return 1.0 / 60; })}},
    {scene(" set Backend = mass-spring\n"),
     all,
     {step_path("implicit step, springs", "corners", [](int) { return 1.0 / 60; })}},
    {scene(" set Backend = pba\n"), few, {step_path("implicit step, points", "phyxels", [](int) { return 1.0 / 60; })}},
    {nullptr,
     all,
     {{"composing a body", "cells", {}, composing},
      {"cutting, with all that follows",
       "edges",
       {},
       [](const int n, const Options& options) { return cutting(n, options, ""); }}}},
    {nullptr,
     few,
     {{"cutting points, with all that follows",
       "edges",
       {},
       [](const int n, const Options& options) { return cutting(n, options, " set Backend = pba\n"); }},
      {"visibility of points that are cut", "edges", {}, [](const int n, const Options& options) {
         return cutting(n, options,
                        " set Backend = pba\n subsection Visibility\n  set Budget [1] = 1000000\n end\n",
                        {"visibility"}); // a stage of its own where it has a budget
       }}}}};
  for (Group& group : groups_beside_steps())
    list.push_back(std::move(group));
  return list;
}

const std::vector<Group>& groups() {
  static const std::vector<Group> list = find_groups();
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
          rows.push_back(row_of(path, n, measured.n_items, measured.sample, measured.need, machine));
        }
        say(rows.back());
      }
    }
  }
  return rows;
}

} // namespace kerf::bench
