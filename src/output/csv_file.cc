#include "output/csv_file.h"

#include "base/parameters.h"
#include "output/checkpoint_file.h"

#include <cmath>
#include <fstream>

namespace kerf::output {

std::string csv_text(const std::string& text) {
  std::string all = "\"";
  for (const char c : text)
    all += c == '"' ? "\"\"" : std::string(1, c);
  return all + "\"";
}

std::string csv_text(const std::int64_t value) { return std::to_string(value); }

std::string csv_text(const double value) { return std::isfinite(value) ? to_text(value) : ""; }

void CsvTable::write(const std::filesystem::path& path) const {
  std::ofstream out(name_beside(path));
  out << head_ << '\n';
  for (const std::string& line : lines_)
    out << line << '\n';
  if (!out.flush())
    throw DataError(Complaint{.file = path.string(),
                              .rule = "cannot be written",
                              .remedy = "Free disk space or raise the quota, or choose another folder with --output"});
  out.close();
  take_name(path);
}

} // namespace kerf::output
