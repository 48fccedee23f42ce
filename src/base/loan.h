#pragma once

/// Vectors for intermediate values whose memory is borrowed: it goes back to the thread when they end, for those that come next.
/// So a step allocates nothing once the steps before have made what it takes, and no object keeps what only its functions need.

#include <cstddef>
#include <utility>
#include <vector>

namespace kerf {

template <class T>
class Loan {
 public:
  using Vector = std::vector<T>;

  /// Empty.
  Loan() : values_(taken()) {}
  explicit Loan(const std::size_t n) : Loan() { values_.resize(n); }
  Loan(const std::size_t n, const T& value) : Loan() { values_.assign(n, value); }
  Loan(const Vector& values) : Loan() { values_ = values; } // NOLINT: a copy of one
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
  auto begin() { return values_.begin(); }
  auto end() { return values_.end(); }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }
  std::size_t size() const { return values_.size(); }
  bool empty() const { return values_.empty(); }

 private:
  static std::vector<Vector>& idle() {
    static thread_local std::vector<Vector> vectors;
    return vectors;
  }
  static Vector taken() {
    auto& all = idle();
    if (all.empty())
      return {};
    Vector values = std::move(all.back());
    all.pop_back();
    values.clear();
    return values;
  }

  Vector values_;
};

} // namespace kerf
