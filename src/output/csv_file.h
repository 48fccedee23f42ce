#pragma once

/// Tables as comma-separated values (RFC 4180): a line of names, then a line a row. Texts stand in quotes; numbers read
/// back as the same ones; those that are not known (NaN) are empty.

#include "output/table_columns.h"

#include <filesystem>

namespace kerf::output {

std::string csv_text(const std::string& text);
std::string csv_text(std::int64_t value);
std::string csv_text(double value);

class CsvTable {
 public:
  explicit CsvTable(const std::size_t n_rows) : lines_(n_rows) {}

  /// As many rows as the table has.
  template <class Row, class T>
  void add(const std::string& name, const Column<Row, T>& column, const std::vector<Row>& rows) {
    head_ += (head_.empty() ? "" : ",") + name;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      Row row = rows[i];
      lines_[i] += (head_ == name ? "" : ",") + csv_text(column.field(row));
    }
  }
  /// Beside what has the name, then in its place. Throws DataError when it cannot be written.
  void write(const std::filesystem::path& path) const;

 private:
  std::string head_;
  std::vector<std::string> lines_;
};

} // namespace kerf::output
