#include "dynamics/forces.h"
#include "dynamics/points.h"

#include "base/parallel.h"
#include "dynamics/conjugate_gradients.h"
#include "dynamics/state.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace kerf::dynamics {

namespace {

void add_stiffness_damping(ForceModel& model, const double beta, const Moment& moment, Points& forces) {
  auto* elastic = dynamic_cast<ElasticModel*>(&model);
  if (!elastic)
    return;
  elastic->linearise(moment.x);
  Loan<Vec3> product(moment.v.size());
  elastic->apply_stiffness(flat(moment.v), flat(*product));
  for (std::size_t i = 0; i < forces.size(); ++i)
    forces[i] -= beta * product[i];
}

} // namespace

void add_load_forces(const Loads& loads, const Moment& moment, Points& forces) {
  for (const auto& load : loads.acting)
    load->add_force(moment, forces);
}

double load_energy(const Loads& loads, const double time, const Points& x) {
  double sum = 0;
  for (const auto& load : loads.acting)
    sum += load->energy(time, x);
  return sum;
}

LoadTangent load_tangent(const Loads& loads, const Tangent kind, const Moment& moment, const double velocity_factor) {
  LoadTangent tangent;
  for (const auto& load : loads.acting)
    load->add_tangent(kind, moment, velocity_factor, tangent);
  return tangent;
}

void applied_force(ForceModel& model, const Loads& loads, const Moment& moment, Points& forces) {
  model.force(moment.x, forces);
  if (loads.stiffness_damping > 0)
    add_stiffness_damping(model, loads.stiffness_damping, moment, forces);
  add_load_forces(loads, moment, forces);
}

void total_force(ForceModel& model, const Loads& loads, const Moment& moment, Points& forces) {
  applied_force(model, loads, moment, forces);
  const auto mass = model.lumped_mass();
  const double alpha = loads.mass_damping;
  parallel_for(
    forces.size(), [&](const std::size_t i) { forces[i] += mass[i] * (loads.gravity - alpha * moment.v[i]); },
    many_corners);
  if (alpha > 0) {
    const Loan<Vec3> more = coupled(model, moment.v);
    for (std::size_t i = 0; i < more.size(); ++i)
      forces[i] -= alpha * more[i];
  }
}

Loan<Vec3> coupled(const ForceModel& model, const Points& v) {
  const MassCoupling* const coupling = model.mass_coupling();
  if (!coupling)
    return Loan<Vec3>::none();
  Loan<Vec3> product(v.size(), Vec3::Zero());
  coupling->add_product(flat(v), flat(*product));
  return product;
}

Loan<Vec3> momenta(const ForceModel& model, const Points& v) {
  const auto mass = model.lumped_mass();
  Loan<Vec3> sum = coupled(model, v);
  const bool is_lumped = sum.empty();
  if (is_lumped)
    sum = Loan<Vec3>(v.size());
  parallel_for(
    v.size(),
    [&](const std::size_t i) {
      const Vec3 more = is_lumped ? Vec3(Vec3::Zero()) : sum[i];
      sum[i] = more + mass[i] * v[i];
    },
    many_corners);
  return sum;
}

double kinetic_energy(const ForceModel& model, const Points& v) {
  const auto mass = model.lumped_mass();
  return kinetic_energy_of_coupling(model, v) +
         sum_in_blocks(v.size(), 0.0, [&](const std::size_t begin, const std::size_t end, double& part) {
           for (std::size_t i = begin; i < end; ++i)
             part += 0.5 * mass[i] * v[i].squaredNorm();
         });
}

double kinetic_energy_of_coupling(const ForceModel& model, const Points& v) {
  const Loan<Vec3> more = coupled(model, v);
  double sum = 0;
  for (std::size_t i = 0; i < more.size(); ++i)
    sum += 0.5 * v[i].dot(more[i]);
  return sum;
}

MassSums mass_sums(const ForceModel& model, const State& state) {
  const auto mass = model.lumped_mass();
  return sum_in_blocks(
    state.x.size(), MassSums(), [&](const std::size_t begin, const std::size_t end, MassSums& part) {
      part += mass_sums(mass, state.x, state.v, begin, end);
    });
}

MassAndMomentum mass_and_momentum(const ForceModel& model, const Points& v) {
  const auto masses = model.lumped_mass();
  return sum_in_blocks(v.size(), MassAndMomentum(),
                       [&](const std::size_t begin, const std::size_t end, MassAndMomentum& part) {
                         for (std::size_t i = begin; i < end; ++i)
                           part += {masses[i], masses[i] * v[i]};
                       });
}

double inner_kinetic_energy(const ForceModel& model, const Pieces& pieces, const Points& v) {
  return inner_kinetic_energy(model, pieces, v, kinetic_energy(model, v),
                              pieces.n() == 1 ? mass_and_momentum(model, v) : MassAndMomentum());
}

double inner_kinetic_energy(const ForceModel& model, const Pieces& pieces, const Points& v, const double kinetic,
                            const MassAndMomentum& all) {
  const auto of_mean = [](const MassAndMomentum& of) {
    return of.mass > 0 ? 0.5 * of.momentum.squaredNorm() / of.mass : 0;
  };
  if (pieces.n() == 1)
    return std::max(0.0, kinetic - of_mean(all));
  const auto mass = model.lumped_mass();
  Loan<MassAndMomentum> of_pieces(pieces.n(), MassAndMomentum());
  for (std::size_t i = 0; i < v.size(); ++i)
    of_pieces[pieces.of(i)] += {mass[i], mass[i] * v[i]};
  return std::max(0.0,
                  std::transform_reduce(of_pieces->begin(), of_pieces->end(), kinetic, std::minus<>(), of_mean));
}

double gravity_energy(const ForceModel& model, const Loads& loads, const Points& x) {
  const auto mass = model.lumped_mass();
  return sum_in_blocks(x.size(), 0.0, [&](const std::size_t begin, const std::size_t end, double& part) {
    for (std::size_t i = begin; i < end; ++i)
      part -= mass[i] * loads.gravity.dot(x[i]);
  });
}

} // namespace kerf::dynamics
