#include "spring/mass_spring.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/parameters.h"
#include "grid/material.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>

namespace kerf::spring {

namespace {

constexpr std::size_t worth_springs = 8192, worth_corners = 4096; // from which on a second thread pays

void require_positive(const std::string& path, const double value) {
  if (!positive.contains(value))
    throw ParameterError({.path = path, .value = to_text(value), .rule = positive.rule()});
}

/// Vertices of a cube that a spring joins: all that differ in one coordinate (edges) or two (face diagonals).
struct Pair {
  int a, b;
  bool is_edge;
};

std::vector<Pair> pairs_of_cube() {
  std::vector<Pair> pairs;
  for (int a = 0; a < 8; ++a)
    for (int b = a + 1; b < 8; ++b)
      if (const int n_different = std::popcount(static_cast<unsigned>(a ^ b)); n_different < 3)
        pairs.push_back({a, b, n_different == 1});
  return pairs;
}

} // namespace

MassSpring::MassSpring(const grid::Solid& solid, const MassSpringOptions& options)
  : numbers_(solid, options.counted), mass_(numbers_.size(), 0.0) {
  require_positive("Density [kg/m^3]", options.density);
  require_positive("Young's modulus [Pa]", options.youngs_modulus);
  std::vector<double> fill(solid.complex.n_copies());
  parallel_for(
    fill.size(),
    [&](const std::size_t c) {
      constexpr double least = 1e-12; // of skin alone, that bounds hardly any
      fill[c] = solid.crumbs.holds(grid::CopyId(c))
                  ? 0
                  : std::max(least, grid::fill(solid, solid.complex.copies[grid::CopyId(c)]));
    },
    256);
  const double eighth = options.density * solid.grid.h() * solid.grid.h() * solid.grid.h() / 8;
  for (const auto c : ids<grid::CopyId>(solid.complex.n_copies()))
    for (const auto corner : solid.complex.copies[c].corners)
      if (numbers_.counts(corner.value))
        mass_[numbers_[corner.value]] += fill[c.value] * eighth;
  add_springs(solid, fill, options);
  find_users();
  inversion_.emplace(solid, numbers_, fill, options.youngs_modulus);
}

void MassSpring::add_springs(const grid::Solid& solid, const std::vector<double>& fill,
                             const MassSpringOptions& options) {
  const grid::CellComplex& complex = solid.complex;
  const double h = solid.grid.h(), modulus = options.youngs_modulus / (1 - poissons_ratio * poissons_ratio);
  const double edge = options.youngs_modulus * h / 10, diagonal = options.youngs_modulus * h / 5;
  const auto pairs = pairs_of_cube();
  std::vector<Spring> all;
  all.reserve(pairs.size() * complex.n_copies());
  for (const auto c : ids<grid::CopyId>(complex.n_copies()))
    for (const Pair& pair : pairs) {
      if (fill[c.value] == 0)
        continue;
      const auto a = numbers_[complex.copies[c].corners[pair.a].value],
                 b = numbers_[complex.copies[c].corners[pair.b].value];
      all.push_back({std::min(a, b), std::max(a, b), fill[c.value] * (pair.is_edge ? edge : diagonal),
                     pair.is_edge ? h : std::sqrt(2.0) * h});
    }
  std::vector<grid::Tie> ties = grid::ties(solid);
  if (options.ties == grid::TieStiffness::of_explicit_steps)
    grid::soften(ties, modulus, 1.2 * options.youngs_modulus / (options.density * h * h), // lambda + 2 mu = 1.2 E
                 [&](const grid::CornerId c) { return mass_[numbers_[c.value]]; });
  for (const grid::Tie& tie : ties) {
    const auto a = numbers_[tie.a.value], b = numbers_[tie.b.value];
    all.push_back({std::min(a, b), std::max(a, b), modulus * tie.length, 0});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Spring& s, const Spring& t) { return s.a != t.a ? s.a < t.a : s.b < t.b; });
  for (const Spring& spring : all) { // sums in the order of the copies
    if (!springs_.empty() && springs_.back().a == spring.a && springs_.back().b == spring.b)
      springs_.back().stiffness += spring.stiffness;
    else
      springs_.push_back(spring);
  }
}

void MassSpring::find_users() {
  user_start_.assign(mass_.size() + 1, 0);
  for (const Spring& s : springs_) {
    ++user_start_[s.a + 1];
    ++user_start_[s.b + 1];
  }
  for (std::size_t c = 0; c < mass_.size(); ++c)
    user_start_[c + 1] += user_start_[c];
  users_.resize(2 * springs_.size());
  std::vector<std::uint32_t> next(user_start_.begin(), user_start_.end() - 1);
  for (std::uint32_t i = 0; i < springs_.size(); ++i) {
    users_[next[springs_[i].a]++] = 2 * i;
    users_[next[springs_[i].b]++] = 2 * i + 1;
  }
}

void MassSpring::gather(const Points& of_springs, double* const y) const {
  parallel_for(
    mass_.size(),
    [&](const std::size_t c) {
      Vec3 sum = Vec3::Zero();
      for (auto k = user_start_[c]; k < user_start_[c + 1]; ++k)
        sum += (users_[k] & 1) != 0 ? Vec3(-of_springs[users_[k] / 2]) : of_springs[users_[k] / 2];
      Eigen::Map<Vec3>(y + 3 * c) = sum;
    },
    worth_corners);
}

double MassSpring::energy_of(const Spring& spring, const Points& x) {
  const double stretch = (x[spring.b] - x[spring.a]).norm() - spring.length;
  return 0.5 * spring.stiffness * stretch * stretch;
}

Loan<double> MassSpring::energies(const Points& x, const dynamics::Pieces& pieces) const {
  Loan<double> sums(pieces.n(), 0);
  for (const Spring& s : springs_)
    sums[pieces.of(s.a)] += energy_of(s, x);
  inversion_->add_energies(x, pieces, sums);
  return sums;
}

double MassSpring::energy(const Points& x) const {
  double sum = 0;
  for (const Spring& s : springs_)
    sum += energy_of(s, x);
  return sum + inversion_->energy(x);
}

void MassSpring::force(const Points& x, Points& forces) const {
  of_springs_.resize(springs_.size());
  parallel_for(
    springs_.size(),
    [&](const std::size_t i) {
      const Spring& s = springs_[i];
      const Vec3 d = x[s.b] - x[s.a];
      const double length = d.norm();
      // A spring of no length has no direction: it waits for its ends to part.
      of_springs_[i] = length > 0 ? Vec3(s.stiffness * (length - s.length) / length * d) : Vec3(Vec3::Zero());
    },
    worth_springs);
  forces.resize(mass_.size());
  gather(of_springs_, forces[0].data());
  inversion_->add_force(x, forces);
}

MassSpring::Direction MassSpring::direction(const Spring& spring, const Points& x, const dynamics::Tangent kind) {
  const Vec3 d = x[spring.b] - x[spring.a];
  const double length = d.norm();
  if (!(length > 0))
    return {Vec3::Zero(), spring.stiffness, spring.stiffness};
  const double across = spring.stiffness * (1 - spring.length / length);
  return {d / length, spring.stiffness, kind == dynamics::Tangent::positive ? std::max(0.0, across) : across};
}

void MassSpring::linearise(const Points& x) {
  directions_.resize(springs_.size());
  parallel_for(
    springs_.size(),
    [&](const std::size_t i) { directions_[i] = direction(springs_[i], x, dynamics::Tangent::positive); },
    worth_springs);
  inversion_->linearise(x);
}

Eigen::SparseMatrix<double> MassSpring::stiffness_matrix(const Points& x, const dynamics::Tangent kind) const {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(36 * springs_.size());
  const auto add = [&](const std::uint32_t a, const std::uint32_t b, const Mat3& block) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        entries.emplace_back(static_cast<int>(3 * a + i), static_cast<int>(3 * b + j), block(i, j));
  };
  for (const Spring& s : springs_) {
    const Mat3 block = direction(s, x, kind).matrix();
    add(s.a, s.a, block);
    add(s.b, s.b, block);
    add(s.a, s.b, -block);
    add(s.b, s.a, -block);
  }
  inversion_->add_entries(x, kind, entries);
  const auto n = static_cast<Eigen::Index>(3 * mass_.size());
  Eigen::SparseMatrix<double> K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

void MassSpring::apply_stiffness(const std::span<const double> p, const std::span<double> y) const {
  of_springs_.resize(springs_.size());
  const auto at = [&](const std::uint32_t c) { return Eigen::Map<const Vec3>(p.data() + 3 * std::size_t(c)); };
  parallel_for(
    springs_.size(),
    [&](const std::size_t i) { of_springs_[i] = directions_[i].times(at(springs_[i].a) - at(springs_[i].b)); },
    worth_springs);
  gather(of_springs_, y.data());
  inversion_->add_product(p, y);
}

void MassSpring::stiffness_diagonal(const PutBlock put) const {
  Loan<Mat3> blocks(mass_.size());
  parallel_for(
    mass_.size(),
    [&](const std::size_t c) {
      Mat3 sum = Mat3::Zero();
      for (auto k = user_start_[c]; k < user_start_[c + 1]; ++k)
        sum += directions_[users_[k] / 2].matrix();
      blocks[c] = sum;
    },
    worth_corners);
  inversion_->add_diagonal(blocks);
  parallel_for(
    blocks.size(), [&](const std::size_t c) { put(c, blocks[c]); }, worth_corners);
}

} // namespace kerf::spring
