#pragma once

/// Room for intermediate numbers of functions that leave their object as it is. Each call borrows its own, so that
/// several threads may call at once; what comes back is kept for the next.

#include <mutex>
#include <utility>
#include <vector>

namespace kerf::fem {

template <class T>
class Scratch {
 public:
  class Loan {
   public:
    Loan(Scratch& owner, std::vector<T> values) : owner_(owner), values_(std::move(values)) {}
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    ~Loan() { owner_.take_back(std::move(values_)); }
    T* data() { return values_.data(); }
    const T* data() const { return values_.data(); }

   private:
    Scratch& owner_;
    std::vector<T> values_;
  };

  /// At least n numbers of any value.
  Loan borrow(const std::size_t n) {
    std::vector<T> values;
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        values = std::move(idle_.back());
        idle_.pop_back();
      }
    }
    values.resize(n);
    return Loan(*this, std::move(values));
  }

 private:
  void take_back(std::vector<T> values) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(values));
  }

  std::mutex mutex_;
  std::vector<std::vector<T>> idle_;
};

} // namespace kerf::fem
