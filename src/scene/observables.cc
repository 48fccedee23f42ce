#include "scene/observables.h"

namespace kerf::scene {

namespace {

double kinetic_energy(const Body& body) {
  const auto mass = body.physics.model->lumped_mass();
  double sum = 0;
  for (std::size_t i = 0; i < mass.size(); ++i)
    sum += 0.5 * mass[i] * body.state.v[i].squaredNorm();
  return sum;
}

double gravity_energy(const Body& body) {
  const auto mass = body.physics.model->lumped_mass();
  double sum = 0;
  for (std::size_t i = 0; i < mass.size(); ++i)
    sum -= mass[i] * body.loads.gravity.dot(body.state.x[i]);
  return sum;
}

double mass(const Body& body) {
  double sum = 0;
  for (const double m : body.physics.model->lumped_mass())
    sum += m;
  return sum;
}

double momentum(const Body& body, const int axis) {
  const auto mass = body.physics.model->lumped_mass();
  double sum = 0;
  for (std::size_t i = 0; i < mass.size(); ++i)
    sum += mass[i] * body.state.v[i][axis];
  return sum;
}

double largest_displacement(const Body& body) {
  double largest = 0;
  for (std::size_t i = 0; i < body.positions.size(); ++i)
    largest = std::max(largest, (body.positions[i] - body.surface.rest[i]).norm());
  return largest;
}

double rest_volume(const Body& body) { return surface::enclosed_volume(body.surface.rest, body.surface.triangles); }

double count(const std::size_t n) { return static_cast<double>(n); }

} // namespace

const std::vector<BodyObservable>& body_observables() {
  static const std::vector<BodyObservable> all = {
    {"kinetic energy", "J", "sum of m v.v / 2 over the corners, lumped mass", kinetic_energy},
    {"elastic energy", "J", "of the force model at the current positions",
     [](const Body& b) { return b.physics.model->energy(b.state.x); }},
    {"gravity energy", "J", "-sum of m g.x over the corners", gravity_energy},
    {"momentum x", "kg m/s", "sum of m v over the corners", [](const Body& b) { return momentum(b, 0); }},
    {"momentum y", "kg m/s", "sum of m v over the corners", [](const Body& b) { return momentum(b, 1); }},
    {"momentum z", "kg m/s", "sum of m v over the corners", [](const Body& b) { return momentum(b, 2); }},
    {"mass", "kg", "sum of the lumped mass", mass},
    {"volume", "m^3", "enclosed by the surface now, divergence theorem over its triangles",
     [](const Body& b) { return surface::enclosed_volume(b.positions, b.surface.triangles); }},
    {"rest volume", "m^3", "enclosed by the surface at rest", rest_volume},
    {"rest volume change", "m^3",
     "rest volume now less that before any cut: what placing cut vertices on a curved "
     "skin gained or lost",
     [](const Body& b) { return rest_volume(b) - b.first_volume; }},
    {"largest displacement", "m", "of a surface vertex from its rest position", largest_displacement},
    {"pieces", "1", "connected components of the copies",
     [](const Body& b) { return count(grid::n_pieces(b.complex)); }},
    {"copies", "1", "cells, once per connected component", [](const Body& b) { return count(b.complex.n_copies()); }},
    {"surface triangles", "1", "of the closed surface",
     [](const Body& b) { return count(b.surface.triangles.size()); }},
    {"cut edges", "1", "grid edges cut by blades and cut surfaces",
     [](const Body& b) {
       std::size_t n = 0;
       if (b.cutting)
         for (const std::size_t m : b.cutting->n_cut_edges)
           n += m;
       return count(n);
     }},
    {"waiting cuts", "1", "cut edges that wait: at most two edges of a cell are cut in a step (thesis §2.4.3)",
     [](const Body& b) { return b.cutting ? count(b.cutting->pending.size()) : 0.0; }},
    {"double crossings", "1", "grid edges that one sweep or cut surface crossed an even number of times, left uncut",
     [](const Body& b) { return b.cutting ? count(b.cutting->n_double_crossings) : 0.0; }},
    {"cells passed uncut", "1",
     "cells whose material a blade passed through without cutting one of their edges, so far (cut/passed.h)",
     [](const Body& b) {
       std::size_t n = 0;
       if (b.cutting)
         for (const cut::PassedCells& passed : b.cutting->passed)
           n += passed.cells().size();
       return count(n);
     }},
    {"solver iterations", "1", "of the linear solver in the step",
     [](const Body& b) { return count(b.report.n_iterations); }},
    {"clamped vertices", "1", "placements that were held at the side of their face or cell",
     [](const Body& b) { return count(b.placed.n_clamped); }},
  };
  return all;
}

const BodyObservable* find_observable(const std::string& name) {
  for (const BodyObservable& observable : body_observables())
    if (observable.name == name)
      return &observable;
  return nullptr;
}

} // namespace kerf::scene
