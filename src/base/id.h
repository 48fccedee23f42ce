#pragma once

/// Typed indices: a face's number does not compile where an edge's is wanted.

#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace kerf {

template <class Tag>
struct Id {
  static constexpr std::uint32_t no_value = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t value = no_value;

  constexpr Id() = default;
  constexpr explicit Id(std::size_t i) : value(static_cast<std::uint32_t>(i)) {}

  constexpr bool valid() const { return value != no_value; }
  constexpr auto operator<=>(const Id&) const = default;
};

/// A vector indexed by one kind of id.
template <class Key, class T>
class Table {
 public:
  Table() = default;
  explicit Table(std::size_t n, const T& value = T()) : items_(n, value) {}

  decltype(auto) operator[](Key key) { return items_[key.value]; }
  decltype(auto) operator[](Key key) const { return items_[key.value]; }

  std::size_t size() const { return items_.size(); }
  void resize(std::size_t n, const T& value = T()) { items_.resize(n, value); }
  void reserve(std::size_t n) { items_.reserve(n); }
  Key push_back(const T& value) {
    items_.push_back(value);
    return Key(items_.size() - 1);
  }

  auto begin() { return items_.begin(); }
  auto end() { return items_.end(); }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }

  std::vector<T>& items() { return items_; }
  const std::vector<T>& items() const { return items_; }

 private:
  std::vector<T> items_;
};

/// All keys of a table of n entries: for (const auto c : ids<CellId>(n)).
template <class Key>
class ids {
 public:
  explicit ids(std::size_t n) : n_(n) {}

  struct iterator {
    std::size_t i;
    Key operator*() const { return Key(i); }
    iterator& operator++() {
      ++i;
      return *this;
    }
    bool operator!=(const iterator& other) const { return i != other.i; }
  };
  iterator begin() const { return {0}; }
  iterator end() const { return {n_}; }

 private:
  std::size_t n_;
};

} // namespace kerf
