#pragma once

/// Forces that elements exert at the positions for which they were asked last, and the energy there: integrators ask
/// again where a step ends and the next one starts, and after a cut between these. A cut changes the elements of some
/// copies, and so the forces of their corners: what else was known stays so. May be asked by several threads at once.

#include "base/vec.h"
#include "fem/batches.h"
#include "fem/incidence.h"
#include "grid/corner_numbers.h"

#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace kerf::fem {

struct ForcesOfElements {
  Points forces;                ///< at each corner [N]
  std::vector<double> energies; ///< of each batch [J]; none where nobody asked and the law's take time
};

/// What a cut has made of known forces, for the same positions.
struct ForcesBeforeCut {
  std::uint64_t at;      ///< fingerprint of the positions
  std::size_t n_corners; ///< then: other ones are new
  ForcesOfElements of_elements;
  ChangeOfBatches change;
  std::vector<std::uint32_t> changed; ///< corners at which the sum over elements is another one
  std::vector<std::uint8_t> is_asked; ///< of each batch: whether it holds such a corner
};

class KnownForces {
 public:
  /// `at`: fingerprint of the positions.
  bool are_known(const std::uint64_t at) const {
    const std::lock_guard lock(mutex_);
    return where_ == at;
  }
  /// False: not known there.
  bool forces(const std::uint64_t at, Points& forces) const {
    const std::lock_guard lock(mutex_);
    if (where_ != at)
      return false;
    forces = of_elements_.forces;
    return true;
  }
  std::optional<double> energy(const std::uint64_t at) const {
    const std::lock_guard lock(mutex_);
    return where_ == at ? energy_ : std::nullopt;
  }
  /// `energy` of the whole body, if it is known; energies of batches are taken from who gives them.
  void put(const std::uint64_t at, const Points& forces, std::vector<double>& energies,
           const std::optional<double>& energy) {
    const std::lock_guard lock(mutex_);
    where_ = at;
    of_elements_.forces = forces;
    of_elements_.energies.swap(energies);
    energy_ = energy;
  }
  /// The same, and gives the memory of earlier forces for what it takes.
  void exchange(const std::uint64_t at, Points& forces, std::vector<double>& energies,
                const std::optional<double>& energy) {
    const std::lock_guard lock(mutex_);
    where_ = at;
    of_elements_.forces.swap(forces);
    of_elements_.energies.swap(energies);
    energy_ = energy;
  }
  void put_energy(const std::uint64_t at, const double energy) {
    const std::lock_guard lock(mutex_);
    if (where_ == at)
      energy_ = energy;
  }

  void forget() {
    const std::lock_guard lock(mutex_);
    where_ = std::nullopt;
    before_ = std::nullopt;
  }
  /// Takes over a cut, after which corners have the numbers that they had. `touched`: of corners, by number, that have
  /// other users, or users that are not what they were.
  void follow(ChangeOfBatches change, const Batching& batching, const Incidence& incidence,
              const grid::CornerNumbers& numbers, std::span<const std::uint32_t> touched);
  /// What is known of these positions since before a cut, which is given once.
  std::optional<ForcesBeforeCut> before_cut(const Points& x) const;

 private:
  mutable std::mutex mutex_;
  std::optional<std::uint64_t> where_;
  ForcesOfElements of_elements_;
  std::optional<double> energy_;
  mutable std::optional<ForcesBeforeCut> before_;
};

} // namespace kerf::fem
