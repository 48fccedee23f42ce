#include "pba/model.h"

#include "base/error.h"
#include "base/parallel.h"
#include "pba/kernel.h"

#include <numeric>

namespace kerf::pba {

namespace {

/// Phyxels from which on a second thread pays: 1 us each in every pass.
constexpr std::size_t worth = 256;

void require(const Range& range, const double value, const char* const name) {
  if (!range.contains(value))
    throw ParameterError({.path = name, .value = to_text(value), .rule = range.rule()});
}

void check(const ModelOptions& options) {
  require(non_negative, options.stabilisation, "Stabilisation [1]");
  require({.min = 0, .max = 1}, options.volume_share, "Volume share [1]");
  require({.min = 0, .max = 0.1, .min_excluded = true}, options.rank_threshold, "Rank threshold [1]");
}

} // namespace

PhyxelModel::PhyxelModel(Phyxels phyxels, const material::Elastic& material, const ModelOptions& options)
  : phyxels_(std::move(phyxels)),
    neighbours_(find_neighbours(phyxels_)),
    options_(options),
    density_(material.density),
    youngs_modulus_(material.youngs_modulus),
    law_{material.mu(), material.lambda(), options.volume_share * std::max(0.0, material.lambda())} {
  check(options);
  const std::size_t n = phyxels_.size();
  for (const double volume : phyxels_.volume)
    mass_.push_back(material.density * volume);
  weights_.assign(neighbours_.pairs.size(), -1.0); // none yet: the first update makes all
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
  return std::span(bonds_).subspan(neighbours_.start[i], neighbours_.start[i + 1] - neighbours_.start[i]);
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
    worth);
}

void PhyxelModel::archive(Archive& a) {
  a.name("phyxels");
  a(mass_, weights_);
  if (a.reads())
    parallel_for(
      phyxels_.size(), [&](const std::size_t i) { make(i); }, worth);
}

void PhyxelModel::carry(const std::span<const std::uint8_t> carried) {
  for (std::size_t i = 0; i < carried.size(); ++i)
    mass_[i] = carried[i] != 0 ? 0 : density_ * phyxels_.volume[i];
}

void PhyxelModel::make(const std::size_t i) {
  Mat3 moment = Mat3::Zero();
  for (auto k = neighbours_.start[i]; k < neighbours_.start[i + 1]; ++k) {
    const std::uint32_t j = neighbours_.phyxel[k];
    const double weight = weights_[neighbours_.pair[k]];
    const Vec3 offset = phyxels_.rest[j] - phyxels_.rest[i];
    bonds_[k] = {weight * offset, weight, j};
    moment += bonds_[k].moment * offset.transpose();
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
  std::vector<Mat3> T(phyxels_.size());
  parallel_for(
    phyxels_.size(),
    [&](const std::size_t i) {
      const Mat3 B = gradient(i, at);
      const Fit& fit = fits_[i];
      T[i] = phyxels_.volume[i] * stress(i, B * fit.used) * fit.used * fit.inverse - kappa_[i] * B;
    },
    worth);
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
    worth);
}

double PhyxelModel::energy(const Points& x) const {
  std::vector<double> energies(phyxels_.size());
  parallel_for(
    phyxels_.size(),
    [&](const std::size_t i) {
      const Mat3 B = gradient(i, [&](const std::size_t j) -> const Vec3& { return x[j]; });
      const Fit& fit = fits_[i];
      double residual = 0;
      for (const Bond& bond : bonds(i))
        residual +=
          bond.weight * (x[bond.other] - x[i] - B * (phyxels_.rest[bond.other] - phyxels_.rest[i])).squaredNorm();
      const Mat3 F = B * fit.used;
      energies[i] =
        phyxels_.volume[i] * energy_density(law_, {F, fit.used, fit.determinant}) + 0.5 * kappa_[i] * residual;
    },
    worth);
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
    worth);
}

void PhyxelModel::apply_stiffness(const std::span<const double> p, const std::span<double> y) const {
  pair_forces([&](const std::size_t i) { return Vec3(p[3 * i], p[3 * i + 1], p[3 * i + 2]); },
              [&](const std::size_t i, const Mat3& dF) { return stress_change(linearised_[i], dF); }, y.data());
  for (double& value : y)
    value = -value;
}

void PhyxelModel::stiffness_diagonal(std::vector<Mat3>& blocks) const {
  blocks.resize(phyxels_.size());
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
      blocks[i] = K + (penalty + kappa_[i] * (total - g.dot(sum))) * Mat3::Identity();
    },
    worth);
}

void PhyxelModel::deformation(const Points& x, std::vector<Mat3>& F) const {
  F.resize(phyxels_.size());
  parallel_for(
    phyxels_.size(),
    [&](const std::size_t i) {
      const Mat3 B = gradient(i, [&](const std::size_t j) -> const Vec3& { return x[j]; });
      F[i] = completed(B * fits_[i].used, fits_[i]);
    },
    worth);
}

} // namespace kerf::pba
