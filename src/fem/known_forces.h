#pragma once

/// Forces at the positions for which they were asked last, and the energy there: integrators ask again where a step
/// ends and the next one starts. May be asked by several threads at once.

#include "base/vec.h"

#include <cstdint>
#include <mutex>
#include <optional>

namespace kerf::fem {

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
    forces = forces_;
    return true;
  }
  std::optional<double> energy(const std::uint64_t at) const {
    const std::lock_guard lock(mutex_);
    return where_ == at ? energy_ : std::nullopt;
  }
  void put(const std::uint64_t at, const Points& forces, const std::optional<double>& energy) {
    const std::lock_guard lock(mutex_);
    where_ = at;
    forces_ = forces;
    energy_ = energy;
  }
  /// The same, and gives the memory of earlier ones for what it takes.
  void exchange(const std::uint64_t at, Points& forces, const std::optional<double>& energy) {
    const std::lock_guard lock(mutex_);
    where_ = at;
    forces_.swap(forces);
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
  }

 private:
  mutable std::mutex mutex_;
  std::optional<std::uint64_t> where_;
  Points forces_;
  std::optional<double> energy_;
};

} // namespace kerf::fem
