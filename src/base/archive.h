#pragma once

/// What a program knows, as bytes that give it back bit by bit. A type that is part of it lists its fields once, in the
/// same order for both ways:
///
///     struct EdgeCut {
///       ...
///       void archive(Archive& a) { a(edge, t, normal, label); }
///     };
///
/// An archive that was made without bytes collects what it is handed; one that was made of bytes fills it. Names stand
/// between the fields of types that hold much, so that bytes of another version are recognised and not misread.
/// Limits: numbers are those of this machine (order of bytes, sizes); whoever keeps the bytes guards them by a
/// checksum.

#include "base/error.h"
#include "base/id.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

namespace kerf {

class Archive {
 public:
  Archive() = default;
  /// `source` names the bytes in errors.
  Archive(std::vector<std::byte> bytes, std::string source)
    : bytes_(std::move(bytes)), source_(std::move(source)), reads_(true) {}

  bool reads() const { return reads_; }
  const std::vector<std::byte>& bytes() const { return bytes_; }
  /// Not read yet; nothing of an archive that collects.
  std::size_t n_left() const { return reads_ ? bytes_.size() - at_ : 0; }

  /// Throws DataError when reading where another name stands.
  void name(const std::string& wanted) {
    std::string found = wanted;
    transfer(found);
    if (found != wanted)
      refuse("'" + wanted + "' was expected where something else stands");
  }

  template <class... T>
  void operator()(T&... values) {
    (transfer(values), ...);
  }

 private:
  template <class T>
  struct IsBits : std::bool_constant<std::is_arithmetic_v<T> || std::is_enum_v<T>> {};
  template <class Tag>
  struct IsBits<Id<Tag>> : std::true_type {};
  template <class T, std::size_t n>
  struct IsBits<std::array<T, n>> : IsBits<T> {};
  template <class T, int rows, int columns>
  struct IsBits<Eigen::Matrix<T, rows, columns>>
    : std::bool_constant<rows != Eigen::Dynamic && columns != Eigen::Dynamic> {};

  [[noreturn]] void refuse(const std::string& what) const {
    throw DataError(
      Complaint{.file = source_,
                .rule = "cannot be read back: " + what,
                .remedy = "It is of another version of the program, or damaged: start again with --force"});
  }

  void raw(void* const value, const std::size_t n) {
    if (n == 0)
      return;
    if (reads_) {
      if (n > n_left())
        refuse("it ends too early");
      std::memcpy(value, bytes_.data() + at_, n);
      at_ += n;
      return;
    }
    const auto* const begin = static_cast<const std::byte*>(value);
    bytes_.insert(bytes_.end(), begin, begin + n);
  }

  /// The size of a container; of one that is read no more than there can be.
  std::size_t count(const std::size_t n) {
    std::uint64_t stored = n;
    raw(&stored, sizeof(stored));
    if (reads_ && stored > n_left())
      refuse("it ends too early");
    return static_cast<std::size_t>(stored);
  }

  template <class T>
  void transfer(T& value) {
    if constexpr (IsBits<T>::value)
      raw(&value, sizeof(T));
    else
      value.archive(*this);
  }

  template <class T, std::size_t n>
  requires(!IsBits<T>::value) void transfer(std::array<T, n>& values) {
    for (T& value : values)
      transfer(value);
  }

  void transfer(std::string& text) {
    text.resize(count(text.size()));
    raw(text.data(), text.size());
  }

  template <class T>
  void transfer(std::vector<T>& values) {
    values.resize(count(values.size()));
    if constexpr (IsBits<T>::value) {
      raw(values.data(), values.size() * sizeof(T));
    } else {
      for (T& value : values)
        transfer(value);
    }
  }

  template <class T>
  void transfer(std::deque<T>& values) {
    values.resize(count(values.size()));
    for (T& value : values)
      transfer(value);
  }

  template <class Key, class T>
  void transfer(Table<Key, T>& table) {
    transfer(table.items());
  }

  template <class T>
  void transfer(std::optional<T>& value) {
    bool is_there = value.has_value();
    transfer(is_there);
    if (reads_ && is_there)
      value.emplace();
    if (reads_ && !is_there)
      value.reset();
    if (is_there)
      transfer(*value);
  }

  template <class T, class Less>
  void transfer(std::set<T, Less>& values) {
    std::vector<T> list(values.begin(), values.end());
    transfer(list);
    if (reads_)
      values = std::set<T, Less>(list.begin(), list.end());
  }

  /// Of a map or an unordered one: pairs by ascending key.
  template <class Map>
  void transfer_pairs(Map& map) {
    std::vector<std::pair<typename Map::key_type, typename Map::mapped_type>> list;
    if (!reads_)
      list.assign(map.begin(), map.end());
    std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    list.resize(count(list.size()));
    for (auto& [key, value] : list) {
      transfer(key);
      transfer(value);
    }
    if (reads_)
      map = Map(list.begin(), list.end());
  }
  template <class Key, class T>
  void transfer(std::map<Key, T>& map) {
    transfer_pairs(map);
  }
  template <class Key, class T>
  void transfer(std::unordered_map<Key, T>& map) {
    transfer_pairs(map);
  }

  std::vector<std::byte> bytes_;
  std::string source_;
  bool reads_ = false;
  std::size_t at_ = 0;
};

} // namespace kerf
