#pragma once

/// Forces at the positions for which they were asked last, and the energy there: integrators ask again where a step ends
/// and the next one starts. May be asked by several threads at once.

#include "base/vec.h"

#include <cstring>
#include <mutex>
#include <optional>

namespace kerf::fem {

class KnownForces {
 public:
  bool are_known(const Points& x) const {
    const std::lock_guard lock(mutex_);
    return is_at(x);
  }
  /// False: not known there.
  bool forces(const Points& x, Points& forces) const {
    const std::lock_guard lock(mutex_);
    if (!is_at(x))
      return false;
    forces = forces_;
    return true;
  }
  std::optional<double> energy(const Points& x) const {
    const std::lock_guard lock(mutex_);
    return is_at(x) ? energy_ : std::nullopt;
  }
  void put(const Points& x, const Points& forces, const std::optional<double>& energy) {
    const std::lock_guard lock(mutex_);
    x_ = x;
    forces_ = forces;
    energy_ = energy;
  }
  void put_energy(const Points& x, const double energy) {
    const std::lock_guard lock(mutex_);
    if (is_at(x))
      energy_ = energy;
  }
  void forget() {
    const std::lock_guard lock(mutex_);
    x_.clear();
  }

 private:
  bool is_at(const Points& x) const {
    return !x_.empty() && x_.size() == x.size() && std::memcmp(x_.data(), x.data(), x.size() * sizeof(Vec3)) == 0;
  }

  mutable std::mutex mutex_;
  Points x_, forces_;
  std::optional<double> energy_;
};

} // namespace kerf::fem
