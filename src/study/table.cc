#include "study/study.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>

namespace kerf::study {

namespace {

using output::StudyRow;

std::string number(const double value, const char* format) {
  if (!std::isfinite(value))
    return "-";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

struct TextColumn {
  std::string name, unit;
  std::function<std::string(const StudyRow&)> text;
  bool to_the_left = false; ///< words begin below each other, numbers end there
};

std::vector<TextColumn> columns(const std::string& unit) {
  const auto count = [](const std::int64_t n) { return std::to_string(n); };
  const auto steps_per_second = [](const StudyRow& r) { return double(r.n_steps) / r.stepping_seconds; };
  return {
    {"row", "", [](const StudyRow& r) { return r.name; }, true},
    {"backend", "", [](const StudyRow& r) { return r.backend; }, true},
    {"integrator", "", [](const StudyRow& r) { return r.integrator; }, true},
    {"h", "m", [](const StudyRow& r) { return number(r.h, "%.4g"); }},
    {"dt", "s", [](const StudyRow& r) { return number(r.dt, "%.4g"); }},
    {"dof", "1", [=](const StudyRow& r) { return count(r.n_dof); }},
    {"value", unit, [](const StudyRow& r) { return number(r.value, "%.5g"); }},
    {"reference", unit, [](const StudyRow& r) { return number(r.reference, "%.5g"); }},
    {"error", "%", [](const StudyRow& r) { return number(100 * r.error, "%+.2f"); }},
    {"order", "1", [](const StudyRow& r) { return number(r.order, "%.2f"); }},
    {"set-up", "s", [](const StudyRow& r) { return number(r.setup_seconds, "%.3f"); }},
    {"stepping", "s", [](const StudyRow& r) { return number(r.stepping_seconds, "%.2f"); }},
    {"CPU", "s", [](const StudyRow& r) { return number(r.cpu_seconds, "%.2f"); }},
    {"steps", "1", [=](const StudyRow& r) { return count(r.n_steps); }},
    {"steps/s", "1/s", [=](const StudyRow& r) { return number(steps_per_second(r), "%.1f"); }},
    {"memory", "MB", [](const StudyRow& r) { return number(r.peak_memory / 1e6, "%.0f"); }},
    {"iterations", "1", [=](const StudyRow& r) { return count(r.n_iterations); }},
    {"outcome", "", [](const StudyRow& r) { return r.outcome; }, true},
  };
}

} // namespace

std::string aligned(const output::StudyTable& table) {
  const std::vector<TextColumn> all = columns(table.unit);
  std::vector<std::vector<std::string>> lines(2 + table.rows.size());
  std::vector<std::size_t> width;
  for (const TextColumn& column : all) {
    lines[0].push_back(column.name);
    lines[1].push_back(column.unit.empty() ? "" : "[" + column.unit + "]");
    for (std::size_t i = 0; i < table.rows.size(); ++i)
      lines[2 + i].push_back(column.text(table.rows[i]));
    width.push_back(0);
    for (const auto& line : lines)
      width.back() = std::max(width.back(), line.back().size());
  }
  std::string text;
  for (const auto& line : lines) {
    std::string row;
    for (std::size_t c = 0; c < all.size(); ++c) {
      const std::string blanks(width[c] - line[c].size(), ' ');
      row += (c == 0 ? "" : "  ") + (all[c].to_the_left ? line[c] + blanks : blanks + line[c]);
    }
    text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

} // namespace kerf::study
