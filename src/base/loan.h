#pragma once

/// Vectors for intermediate values whose memory is borrowed: it goes back to the thread when they end, for those that
/// come next. So a step allocates nothing once the steps before have made what it takes, and no object keeps what only
/// its functions need.
///
/// Lent is the smallest memory that is large enough, and where none is, the largest: it grows. So who says at once how
/// much he takes does not make small vectors large, and there are no more large ones than are in use at a time.

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace kerf {

/// What to make room for where n values are some more than there were: cuts add few at a time, and the next finds room.
constexpr std::size_t with_slack(const std::size_t n) { return n + n / 16; }

/// Resizes with such room, where std::vector takes twice the memory.
template <class Vector>
void grow(Vector& values, const std::size_t n, const typename Vector::value_type& value = {}) {
  if (n > values.capacity())
    values.reserve(with_slack(n));
  values.resize(n, value);
}

/// For vectors that are written before they are read.
struct AnyValues {};

template <class T>
class Loan {
 public:
  using Vector = std::vector<T>;

  /// Empty.
  Loan() : Loan(with_room(0)) {}
  explicit Loan(const std::size_t n) : Loan(with_room(n)) { values_.resize(n); }
  Loan(const std::size_t n, const T& value) : Loan(with_room(n)) { values_.assign(n, value); }
  Loan(const std::size_t n, AnyValues) : values_(taken(n)) { values_.resize(n); }
  Loan(const Vector& values) : Loan(with_room(values.size())) { values_ = values; } // NOLINT: a copy of one
  /// Without memory, for what will have no values.
  static Loan none() { return Loan(Vector()); }
  /// Empty, but to be of n values later.
  static Loan with_room(const std::size_t n) {
    Vector values = taken(n);
    values.clear();
    return Loan(std::move(values));
  }
  Loan(Loan&& other) noexcept : values_(std::exchange(other.values_, {})) {}
  Loan(const Loan&) = delete;
  Loan& operator=(const Loan&) = delete;
  Loan& operator=(Loan&& other) noexcept {
    std::swap(values_, other.values_);
    return *this;
  }
  ~Loan() {
    if (values_.capacity() > 0)
      idle().push_back(std::move(values_));
  }

  Vector& operator*() { return values_; }
  const Vector& operator*() const { return values_; }
  Vector* operator->() { return &values_; }
  const Vector* operator->() const { return &values_; }
  operator Vector&() { return values_; }             // NOLINT: it is one
  operator const Vector&() const { return values_; } // NOLINT
  T& operator[](const std::size_t i) { return values_[i]; }
  const T& operator[](const std::size_t i) const { return values_[i]; }
  T* data() { return values_.data(); }
  const T* data() const { return values_.data(); }
  auto begin() { return values_.begin(); }
  auto end() { return values_.end(); }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }
  std::size_t size() const { return values_.size(); }
  bool empty() const { return values_.empty(); }

 private:
  explicit Loan(Vector&& values) : values_(std::move(values)) {}

  static std::vector<Vector>& idle() {
    static thread_local std::vector<Vector> vectors;
    return vectors;
  }
  /// With room for n values, and what was in it.
  static Vector taken(const std::size_t n) {
    auto& all = idle();
    if (all.empty())
      return {};
    const auto fits_better = [n](const Vector& a, const Vector& b) {
      const bool a_fits = a.capacity() >= n, b_fits = b.capacity() >= n;
      return a_fits != b_fits ? a_fits : a_fits ? a.capacity() < b.capacity() : a.capacity() > b.capacity();
    };
    const auto best = std::min_element(all.begin(), all.end(), fits_better);
    Vector values = std::move(*best);
    *best = std::move(all.back());
    all.pop_back();
    if (const std::size_t had = values.capacity(); had < n) {
      values = {}; // not both at a time
      values.reserve(had > n / 2 ? with_slack(n) : n);
    }
    return values;
  }

  Vector values_;
};

} // namespace kerf
