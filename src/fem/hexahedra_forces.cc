#include "base/fingerprint.h"
#include "base/loan.h"
#include "base/parallel.h"
#include "dynamics/state.h"
#include "fem/hexahedra.h"
#include "fem/two_rows.h"
#include "material/polar.h"

#include <algorithm>
#include <numeric>

namespace kerf::fem {

namespace {

Mat3 gradient_of(const Turns& turns, const std::size_t lane) {
  Mat3 F;
  for (int i = 0; i < 9; ++i)
    F.data()[i] = turns.F[i][lane];
  return F;
}

void find_rotation(const double* const F, double* const R) {
  Eigen::Map<Mat3> found(R);
  found = material::rotation_of(Eigen::Map<const Mat3>(F));
}

} // namespace

Turns Hexahedra::turns(const std::size_t batch, const Row<double>* const x) const {
  Turns all;
  const auto put = [&](const std::size_t lane, const Mat3& R) {
    for (int i = 0; i < 9; ++i)
      all.R[i][lane] = R.data()[i];
  };
  if (frame_ == Frame::fixed) {
    all = {};
    for (std::size_t lane = 0; lane < n_lanes; ++lane)
      put(lane, Mat3::Identity());
    return all;
  }
  const unsigned unknown = force_kernels().turn(batched_.cube, batched_.batch(*batching_, batch), x, all);
  for_each_lane(batch, [&](const std::size_t lane, std::uint32_t) {
    if ((unknown >> lane & 1) != 0)
      put(lane, material::rotation_of(gradient_of(all, lane)));
  });
  return all;
}

double Hexahedra::sum_energies(const Points& x, const std::vector<double>& of_batches) const {
  return std::accumulate(of_batches.begin(), of_batches.end(), ghost_penalty_.energy(x) + ties_.energy(x));
}

/// What a lane has, and what the law says of it.
double Hexahedra::energy_of(const Turns& turns, const double* const of_lanes, const std::size_t lane,
                            const std::uint32_t copy) const {
  return is_hookean() ? of_lanes[lane]
                      : of_lanes[lane] + elements_[copy].volume * std::visit(
                                                                    [&](const auto& law) {
                                                                      return law.energy(gradient_of(turns, lane));
                                                                    },
                                                                    law_);
}

double Hexahedra::energy_of_batch(const std::size_t batch, const Turns& turns, const double* const of_lanes) const {
  double sum = 0;
  for_each_lane(batch, [&](const std::size_t lane, const std::uint32_t copy) {
    sum += energy_of(turns, of_lanes, lane, copy);
  });
  return sum;
}

Loan<double> Hexahedra::energies(const Points& x, const dynamics::Pieces& pieces) const {
  const TwoRows lent(batching_->n_rows());
  Row<double>* const rows = lent.first;
  put_rows(dynamics::flat(x), batching_->n_rows(), rows);
  Loan<double> of_copies(incidence_.n_copies(), 0), sums(pieces.n(), 0);
  batching_->for_each([&](const std::size_t i) {
    const Turns turns = this->turns(i, rows);
    alignas(64) double of_lanes[n_lanes];
    force_kernels().energy(batched_.cube, batched_.batch(*batching_, i), turns, mean_part(), rows, of_lanes);
    for_each_lane(i, [&](const std::size_t lane, const std::uint32_t copy) {
      of_copies[copy] = energy_of(turns, of_lanes, lane, copy);
    });
  });
  for (std::size_t copy = 0; copy < of_copies.size(); ++copy)
    if (of_copies[copy] != 0)
      sums[pieces.of(corner_numbers(copy)[0])] += of_copies[copy];
  ghost_penalty_.add_energies(x, pieces, sums);
  ties_.add_energies(x, pieces, sums);
  return sums;
}

double Hexahedra::energy(const Points& x) const {
  if (const auto known = known_.energy(fingerprint(x)))
    return *known;
  const TwoRows lent(batching_->n_rows());
  Row<double>* const rows = lent.first;
  put_rows(dynamics::flat(x), batching_->n_rows(), rows);
  Loan<double> energies(batching_->batches().size());
  batching_->for_each([&](const std::size_t i) {
    const Turns turns = this->turns(i, rows);
    alignas(64) double of_lanes[n_lanes];
    force_kernels().energy(batched_.cube, batched_.batch(*batching_, i), turns, mean_part(), rows, of_lanes);
    energies[i] = energy_of_batch(i, turns, of_lanes);
  });
  return sum_energies(x, energies);
}

double Hexahedra::energy_ahead(const Points& x) const {
  const std::uint64_t at = fingerprint(x);
  if (known_.are_known(at)) {
    const double energy = this->energy(x);
    known_.put_energy(at, energy);
    return energy;
  }
  Loan<Vec3> forces = Loan<Vec3>::with_room(x.size());
  Loan<double> energies = Loan<double>::with_room(batching_->batches().size());
  find_forces(x, WithEnergy::always, forces, energies);
  const double energy = sum_energies(x, energies);
  known_.exchange(at, forces, energies, energy);
  return energy;
}

void Hexahedra::force(const Points& x, Points& forces) const {
  if (const std::uint64_t at = fingerprint(x); !known_.forces(at, forces)) {
    Loan<double> energies = Loan<double>::with_room(batching_->batches().size());
    find_forces(x, WithEnergy::where_cheap, forces, energies);
    known_.put(at, forces, energies,
               gives_energies(WithEnergy::where_cheap) ? std::optional(sum_energies(x, energies)) : std::nullopt);
  }
  add_forces_between(x, forces);
}

void Hexahedra::add_forces_between(const Points& x, Points& forces) const {
  ghost_penalty_.add_force(x, forces);
  ties_.add_force(x, forces);
}

/// Adds the forces of a batch, and returns its energy, which for laws other than Hooke's is asked for or zero.
double Hexahedra::add_forces(const std::size_t batch, const WithEnergy with_energy, const Row<double>* const x,
                             Row<double>* const forces) const {
  const Batch<double> of_batch = batched_.batch(*batching_, batch);
  alignas(64) double of_lanes[n_lanes];
  if (is_hookean() && frame_ == Frame::turning) {
    force_kernels().turned_force(batched_.cube, of_batch, find_rotation, x, forces, of_lanes);
    return std::accumulate(of_lanes, of_lanes + of_batch.n_used, 0.0);
  }
  const Turns turns = this->turns(batch, x);
  const double spins = frame_ == Frame::turning ? 1 : 0;
  alignas(64) double stress[9][n_lanes];
  if (!is_hookean()) {
    std::fill_n(stress[0], 9 * n_lanes, 0.0);
    for_each_lane(batch, [&](const std::size_t lane, const std::uint32_t copy) {
      const Mat3 P = elements_[copy].volume *
                     std::visit([&](const auto& law) { return Mat3(law.stress(gradient_of(turns, lane))); }, law_);
      for (int k = 0; k < 9; ++k)
        stress[k][lane] = P.data()[k];
    });
  }
  const bool is_asked = with_energy == WithEnergy::always || is_hookean();
  force_kernels().force(batched_.cube, of_batch, turns, mean_part(), is_hookean() ? nullptr : stress, spins, x, forces,
                        is_asked ? of_lanes : nullptr);
  return is_asked ? energy_of_batch(batch, turns, of_lanes) : 0;
}

void Hexahedra::find_forces(const Points& x, const WithEnergy with_energy, Points& forces,
                            std::vector<double>& energies) const {
  if (update_forces(x, with_energy, forces, energies))
    return;
  const TwoRows lent(batching_->n_rows());
  Row<double>*const rows = lent.first, *const sums = lent.second;
  put_rows(dynamics::flat(x), batching_->n_rows(), rows, sums);
  energies.assign(gives_energies(with_energy) ? batching_->batches().size() : 0, 0.0);
  batching_->for_each_in_order([&](const std::size_t i) {
    const double energy = add_forces(i, with_energy, rows, sums);
    if (!energies.empty())
      energies[i] = energy;
  });
  forces.resize(numbers_.size());
  write(sums, dynamics::flat(forces));
}

bool Hexahedra::update_forces(const Points& x, const WithEnergy with_energy, Points& forces,
                              std::vector<double>& energies) const {
  std::optional<ForcesBeforeCut> before = known_.before_cut(x);
  if (!before || (gives_energies(with_energy) && before->of_elements.energies.empty()))
    return false;
  const std::span<const BatchOfCopies> batches = batching_->batches();
  energies.assign(gives_energies(with_energy) ? batches.size() : 0, 0.0);
  const TwoRows lent(batching_->n_rows());
  Row<double>*const rows = lent.first, *const sums = lent.second;
  for (const std::uint32_t corner : before->changed)
    sums[corner] = {};
  for (std::size_t i = 0; i < batches.size(); ++i)
    if (before->is_asked[i] != 0)
      for (const auto& corners : batches[i].corners)
        for (const std::uint32_t corner : corners) {
          rows[corner] = corner < x.size() ? Row<double>{x[corner].x(), x[corner].y(), x[corner].z()} : Row<double>{};
          sums[corner] = {};
        }
  batching_->for_each_in_order([&](const std::size_t i) {
    const bool is_asked = before->is_asked[i] != 0;
    const double energy = is_asked ? add_forces(i, with_energy, rows, sums) : 0;
    if (!energies.empty())
      energies[i] = is_asked ? energy : before->of_elements.energies[before->change.was[i]];
  });
  forces.swap(before->of_elements.forces);
  forces.resize(x.size());
  for (const std::uint32_t corner : before->changed)
    forces[corner] = {sums[corner].x, sums[corner].y, sums[corner].z};
  return true;
}

void Hexahedra::linearise(const Points& x) {
  if (shares_diagonal() && multigrid_ && diagonal_.empty())
    diagonal_ = multigrid_->lend_diagonal();
  of_diagonal_ = shares_diagonal() && (multigrid_ || !former_levels_.coarse.empty()) ? OfDiagonal::wanted
                                                                                : OfDiagonal::unwanted;
  const TwoRows lent(batching_->n_rows());
  Row<double>* const rows = lent.first;
  put_rows(dynamics::flat(x), batching_->n_rows(), rows);
  const std::size_t n = batching_->batches().size();
  batched_.tangents.resize(is_hookean() ? 0 : n);
  batching_->for_each([&](const std::size_t i) {
    const Turns turns = this->turns(i, rows);
    std::copy_n(turns.R[0], 9 * n_lanes, (*batched_.shared.rotations)[i].row[0]);
    if (is_hookean())
      return;
    for_each_lane(i, [&](const std::size_t lane, const std::uint32_t copy) {
      const material::Tangent A =
        elements_[copy].volume *
        std::visit(
          [&](const auto& law) { return material::Tangent(law.positive_tangent(gradient_of(turns, lane))); }, law_);
      for (int p = 0; p < 9; ++p)
        for (int q = 0; q <= p; ++q)
          batched_.tangents[i].row[pair_index(p, q)][lane] = A(p, q);
    });
  });
}

} // namespace kerf::fem
