#pragma once

/// Tables in HDF5: one column a dataset, all of the same length, one entry a row; attributes unit and description. What
/// the columns are is told by a function that calls an action for each.

#include "base/error.h"
#include "output/h5_array.h"

#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

namespace kerf::output {

/// A field of a row; T is std::string, double, or std::int64_t.
template <class Row, class T>
struct Column {
  std::string name;
  std::function<T&(Row&)> field;
  std::string unit, description;
};

/// Calls the action with each column that it is told.
template <class Row, class Action>
struct Columns {
  const Action& action;

  void text(const char* name, std::string Row::*field, const char* description) const {
    action(Column<Row, std::string>{name, std::mem_fn(field), "1", description});
  }
  void number(const char* name, double Row::*field, const std::string& unit, const char* description) const {
    number(name, std::mem_fn(field), unit, description);
  }
  void number(const std::string& name, std::function<double&(Row&)> field, const std::string& unit,
              const std::string& description) const {
    action(Column<Row, double>{name, std::move(field), unit, description});
  }
  void count(const char* name, std::int64_t Row::*field, const char* description) const {
    action(Column<Row, std::int64_t>{name, std::mem_fn(field), "1", description});
  }
};

inline std::string column_path(const std::string& group, const std::string& column) { return group + "/" + column; }

/// Below a group that is there.
template <class Row, class T>
void write_column(const h5::Object& root, const std::string& group, const Column<Row, T>& column,
                  const std::vector<Row>& rows) {
  std::vector<T> values;
  for (Row row : rows)
    values.push_back(column.field(row));
  const h5::Object dataset = [&] {
    if constexpr (std::is_same_v<T, std::string>)
      return h5::write_lines(root, column_path(group, column.name), values);
    else
      return h5::write_vector(root, column_path(group, column.name), values);
  }();
  h5::set_attribute(dataset, "unit", column.unit);
  h5::set_attribute(dataset, "description", column.description);
}

/// Fills the field of all rows. Throws DataError when there are not as many entries.
template <class Row, class T>
void read_column(const h5::Object& root, const std::string& group, const Column<Row, T>& column,
                 std::vector<Row>& rows) {
  const auto values = [&] {
    if constexpr (std::is_same_v<T, std::string>)
      return h5::read_lines(root, column_path(group, column.name));
    else
      return h5::read_vector<T>(root, column_path(group, column.name));
  }();
  if (values.size() != rows.size())
    throw DataError({.file = root.file,
                     .path = column_path(group, column.name),
                     .value = std::to_string(values.size()),
                     .rule = "must have an entry for each of the " + std::to_string(rows.size()) + " rows",
                     .remedy = "Read a file that Kerf wrote"});
  for (std::size_t i = 0; i < values.size(); ++i)
    column.field(rows[i]) = values[i];
}

} // namespace kerf::output
