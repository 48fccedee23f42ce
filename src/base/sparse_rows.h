#pragma once

/// Rows of a sparse matrix of weights: of points that follow corners (interpolation.h), of corners that follow phyxels
/// or coarse corners, of regions of corners.

#include "base/archive.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kerf {

template <class Value>
struct SparseRows {
  std::vector<std::uint32_t> start = {0}; ///< of each row's entries, and their end
  std::vector<std::uint32_t> columns = {};
  std::vector<Value> values = {}; ///< [1]

  void archive(Archive& a) { a(start, columns, values); }
  std::size_t n_rows() const { return start.size() - 1; }

  void add_entry(const std::uint32_t column, const Value value) {
    columns.push_back(column);
    values.push_back(value);
  }
  /// Of the entries that were added since the last row.
  void end_row() { start.push_back(static_cast<std::uint32_t>(columns.size())); }
  void add_row(const std::span<const std::uint32_t> of_columns, const std::span<const Value> of_values) {
    columns.insert(columns.end(), of_columns.begin(), of_columns.end());
    values.insert(values.end(), of_values.begin(), of_values.end());
    end_row();
  }
};

} // namespace kerf
