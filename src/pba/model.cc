#include "pba/model.h"

#include "base/error.h"
#include "base/loan.h"
#include "base/parallel.h"
#include "material/polar.h"
#include "pba/kernel.h"

#include <Eigen/LU>

#include <algorithm>
#include <numeric>

namespace kerf::pba {

namespace {

/// Phyxels from which on a second thread pays: 1 us each in every pass.
constexpr std::size_t many_phyxels = 256;

void require(const Range& range, const double value, const char* const name) {
  if (!range.contains(value))
    throw ParameterError({.path = name, .value = to_text(value), .rule = range.rule()});
}

/// F^-1 v; where F has hardly any volume, what its rotation leaves.
Vec3 undone(const Mat3& F, const Vec3& v) {
  constexpr double flat = 0.1;
  return F.determinant() > flat ? Vec3(F.inverse() * v) : Vec3(material::rotation_of(F).transpose() * v);
}

void check(const ModelOptions& options) {
  require(non_negative, options.stabilisation, "Stabilisation [1]");
  require({.min = 0, .max = 1}, options.volume_share, "Volume share [1]");
  require({.min = 0, .max = 0.1, .min_excluded = true}, options.rank_threshold, "Rank threshold [1]");
}

} // namespace

PhyxelModel::PhyxelModel(Phyxels phyxels, const material::Elastic& material, const ModelOptions& options)
  : PhyxelModel(phyxels, find_neighbours(phyxels), material, options) {}

PhyxelModel::PhyxelModel(Phyxels phyxels, Neighbours neighbours, const material::Elastic& material,
                         const ModelOptions& options)
  : phyxels_(std::move(phyxels)),
    neighbours_(std::move(neighbours)),
    options_(options),
    density_(material.density),
    youngs_modulus_(material.youngs_modulus),
    law_{material.mu(), material.lambda(), options.volume_share * std::max(0.0, material.lambda())} {
  check(options);
  const std::size_t n = phyxels_.size();
  for (const double volume : phyxels_.volume)
    mass_.push_back(material.density * volume);
  weights_.assign(neighbours_.pairs.size(), -1.0); // none yet: the first update makes all
  links_ = neighbours_of({}, n);
  bonds_.resize(neighbours_.phyxel.size());
  fits_.resize(n);
  kappa_.assign(n, 0.0);
  linearised_.resize(n);
  reference_.assign(n, 0.0);
  const auto clear = clear_sights(phyxels_.rest, phyxels_.rest, neighbours_.pairs);
  for (std::size_t p = 0; p < clear.size(); ++p)
    for (const auto i : neighbours_.pairs[p])
      reference_[i] += weight(clear[p], neighbours_.support[p]) * clear[p].distance * clear[p].distance / 3;
  update(clear);
  linearise(phyxels_.rest);
}

std::span<const PhyxelModel::Bond> PhyxelModel::bonds(const std::size_t i) const {
  const auto first = neighbours_.start[i] + links_.start[i];
  return std::span(bonds_).subspan(first, neighbours_.start[i + 1] + links_.start[i + 1] - first);
}

void PhyxelModel::update(const std::span<const Sight> sights) {
  std::vector<std::uint8_t> changed(phyxels_.size(), 0);
  for (std::size_t p = 0; p < weights_.size(); ++p) {
    const double weight = pba::weight(sights[p], neighbours_.support[p]);
    if (weight == weights_[p])
      continue;
    weights_[p] = weight;
    for (const auto i : neighbours_.pairs[p])
      changed[i] = 1;
  }
  parallel_for(
    phyxels_.size(),
    [&](const std::size_t i) {
      if (changed[i])
        make(i);
    },
    many_phyxels);
}

Deformed PhyxelModel::deformed(const Points& x) const {
  Deformed all;
  deformation(x, all.F);
  std::ranges::transform(fits_, std::back_inserter(all.known), &Fit::determinant);
  return all;
}

void PhyxelModel::link(const std::span<const Link> links, const Points& x, const Deformed& before) {
  if (links.empty() && links_.pairs.empty())
    return;
  std::vector<Link> sorted(links.begin(), links.end());
  std::sort(sorted.begin(), sorted.end(), [](const Link& a, const Link& b) { return a.pair < b.pair; });
  const auto size = [&](const std::uint32_t i) { return reference_[i] > 0 ? phyxels_.volume[i] / reference_[i] : 0.0; };
  constexpr double hardly = 1e-6; // counts where both know nothing
  std::vector<Pair> pairs;
  std::vector<double> weights;
  Points offsets;
  for (const auto& [pair, length, area] : sorted) {
    const auto [i, j] = pair;
    const double weight = std::min(1.0, area / (length * (size(i) + size(j))));
    const auto known = std::lower_bound(links_.pairs.begin(), links_.pairs.end(), pair);
    const auto earlier = static_cast<std::size_t>(known - links_.pairs.begin());
    const bool is_new = known == links_.pairs.end() || *known != pair;
    const auto at_rest = [&, i = i, j = j] {
      const Vec3 way = x[j] - x[i];
      const double of_i = before.known[i] + hardly, of_j = before.known[j] + hardly;
      return Vec3((of_i * undone(before.F[i], way) + of_j * undone(before.F[j], way)) / (of_i + of_j));
    };
    offsets.push_back(is_new ? at_rest() : link_offsets_[earlier]);
    weights.push_back(is_new ? weight : std::min(weight, link_weights_[earlier]));
    pairs.push_back(pair);
  }
  links_ = neighbours_of(std::move(pairs), phyxels_.size());
  link_weights_ = std::move(weights);
  link_offsets_ = std::move(offsets);
  make_all();
}

void PhyxelModel::archive(Archive& a) {
  a.name("phyxels");
  a(mass_, weights_, links_.pairs, link_weights_, link_offsets_);
  if (!a.reads())
    return;
  links_ = neighbours_of(std::move(links_.pairs), phyxels_.size());
  make_all();
}

void PhyxelModel::make_all() {
  bonds_.resize(neighbours_.phyxel.size() + links_.phyxel.size());
  parallel_for(
    phyxels_.size(), [&](const std::size_t i) { make(i); }, many_phyxels);
}

void PhyxelModel::carry(const std::span<const std::uint8_t> carried) {
  for (std::size_t i = 0; i < carried.size(); ++i)
    mass_[i] = carried[i] != 0 ? 0 : density_ * phyxels_.volume[i];
}

void PhyxelModel::make(const std::size_t i) {
  Mat3 moment = Mat3::Zero();
  Bond* bond = &bonds_[neighbours_.start[i] + links_.start[i]];
  const auto add = [&](const std::uint32_t j, const double weight, const Vec3& offset) {
    *bond = {weight * offset, weight, offset, j};
    moment += bond->moment * offset.transpose();
    ++bond;
  };
  for (auto k = neighbours_.start[i]; k < neighbours_.start[i + 1]; ++k) {
    const std::uint32_t j = neighbours_.phyxel[k];
    add(j, weights_[neighbours_.pair[k]], phyxels_.rest[j] - phyxels_.rest[i]);
  }
  for (auto k = links_.start[i]; k < links_.start[i + 1]; ++k) {
    const std::uint32_t j = links_.phyxel[k], l = links_.pair[k];
    add(j, link_weights_[l], i < j ? link_offsets_[l] : Vec3(-link_offsets_[l]));
  }
  fits_[i] = fit(moment, reference_[i], options_.rank_threshold);
  kappa_[i] = reference_[i] > 0 ? options_.stabilisation * youngs_modulus_ * phyxels_.volume[i] / reference_[i] : 0.0;
}

template <class At>
Mat3 PhyxelModel::gradient(const std::size_t i, const At& at) const {
  Mat3 C = Mat3::Zero();
  const Vec3 here = at(i);
  for (const Bond& bond : bonds(i))
    C += (at(bond.other) - here) * bond.moment.transpose();
  return C * fits_[i].inverse;
}

template <class At, class Stress>
void PhyxelModel::pair_forces(const At& at, const Stress& stress, double* const forces) const {
  Loan<Mat3> lent(phyxels_.size());
  std::vector<Mat3>& T = lent;
  parallel_for(
    phyxels_.size(),
    [&](const std::size_t i) {
      const Mat3 B = gradient(i, at);
      const Fit& fit = fits_[i];
      T[i] = phyxels_.volume[i] * stress(i, B * fit.used) * fit.used * fit.inverse - kappa_[i] * B;
    },
    many_phyxels);
  parallel_for(
    phyxels_.size(),
    [&](const std::size_t i) {
      Vec3 sum = Vec3::Zero();
      const Vec3 here = at(i);
      for (const Bond& bond : bonds(i))
        sum += (T[i] + T[bond.other]) * bond.moment +
               (kappa_[i] + kappa_[bond.other]) * bond.weight * (at(bond.other) - here);
      Eigen::Map<Vec3>(forces + 3 * i) = sum;
    },
    many_phyxels);
}

double PhyxelModel::energy(const Points& x) const {
  Loan<double> energies(phyxels_.size());
  parallel_for(
    phyxels_.size(),
    [&](const std::size_t i) {
      const Mat3 B = gradient(i, [&](const std::size_t j) -> const Vec3& { return x[j]; });
      const Fit& fit = fits_[i];
      double residual = 0;
      for (const Bond& bond : bonds(i))
        residual += bond.weight * (x[bond.other] - x[i] - B * bond.offset).squaredNorm();
      const Mat3 F = B * fit.used;
      energies[i] =
        phyxels_.volume[i] * energy_density(law_, {F, fit.used, fit.determinant}) + 0.5 * kappa_[i] * residual;
    },
    many_phyxels);
  return std::accumulate(energies.begin(), energies.end(), 0.0);
}

void PhyxelModel::force(const Points& x, Points& forces) const {
  forces.resize(phyxels_.size());
  pair_forces([&](const std::size_t i) -> const Vec3& { return x[i]; },
              [&](const std::size_t i, const Mat3& F) {
                return stress(law_, {F, fits_[i].used, fits_[i].determinant});
              },
              forces[0].data());
}

void PhyxelModel::linearise(const Points& x) {
  parallel_for(
    phyxels_.size(),
    [&](const std::size_t i) {
      const Fit& fit = fits_[i];
      const Mat3 F = gradient(i, [&](const std::size_t j) -> const Vec3& { return x[j]; }) * fit.used;
      linearised_[i] = pba::linearise(law_, {F, fit.used, fit.determinant}, options_.tangent);
    },
    many_phyxels);
}

void PhyxelModel::apply_stiffness(const std::span<const double> p, const std::span<double> y) const {
  pair_forces([&](const std::size_t i) { return Vec3(p[3 * i], p[3 * i + 1], p[3 * i + 2]); },
              [&](const std::size_t i, const Mat3& dF) { return stress_change(linearised_[i], dF); }, y.data());
  for (double& value : y)
    value = -value;
}

void PhyxelModel::stiffness_diagonal(const PutBlock put) const {
  parallel_for(
    phyxels_.size(),
    [&](const std::size_t i) {
      Vec3 sum = Vec3::Zero();
      double total = 0, penalty = 0;
      Mat3 K = Mat3::Zero();
      for (const Bond& bond : bonds(i)) {
        sum += bond.moment;
        total += bond.weight;
        const Fit& other = fits_[bond.other];
        const Vec3 g = -(other.inverse * bond.moment); // of the other's gradient, by this position
        K += phyxels_.volume[bond.other] * block(linearised_[bond.other], other.used * g);
        penalty += kappa_[bond.other] * (bond.weight + g.dot(bond.moment));
      }
      const Vec3 g = fits_[i].inverse * sum;
      K += phyxels_.volume[i] * block(linearised_[i], fits_[i].used * g);
      put(i, K + (penalty + kappa_[i] * (total - g.dot(sum))) * Mat3::Identity());
    },
    many_phyxels);
}

void PhyxelModel::deformation(const Points& x, std::vector<Mat3>& F) const {
  F.resize(phyxels_.size());
  parallel_for(
    phyxels_.size(),
    [&](const std::size_t i) {
      const Mat3 B = gradient(i, [&](const std::size_t j) -> const Vec3& { return x[j]; });
      F[i] = completed(B * fits_[i].used, fits_[i]);
    },
    many_phyxels);
}

} // namespace kerf::pba
