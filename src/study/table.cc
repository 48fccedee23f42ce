#include "study/study.h"

#include <algorithm>
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

/// Errors of norms, and of displacements at points, in the order of the table's file.
std::vector<TextColumn> error_columns(const output::StudyTable& table) {
  std::vector<TextColumn> columns;
  if (!table.points.empty()) {
    columns.push_back({"L2", "%", [](const StudyRow& r) { return number(100 * r.error_l2, "%.2f"); }});
    columns.push_back({"max", "%", [](const StudyRow& r) { return number(100 * r.error_max, "%.2f"); }});
  }
  for (std::size_t k = 0; k < table.norms.size(); ++k)
    columns.push_back(
      {table.norms[k].name, "%", [k](const StudyRow& r) { return number(100 * r.norms[k].error, "%+.2f"); }});
  return columns;
}

/// How far the times of repetitions lie apart, where there are any.
std::vector<TextColumn> spread_columns(const output::StudyTable& table) {
  const auto is_repeated = [](const StudyRow& row) { return row.n_repetitions > 1; };
  if (std::none_of(table.rows.begin(), table.rows.end(), is_repeated))
    return {};
  return {{"runs", "1", [](const StudyRow& r) { return std::to_string(r.n_repetitions); }},
          {"set-up +-", "s", [](const StudyRow& r) { return number(r.setup_spread / 2, "%.3f"); }},
          {"stepping +-", "s", [](const StudyRow& r) { return number(r.stepping_spread / 2, "%.2f"); }},
          {"CPU +-", "s", [](const StudyRow& r) { return number(r.cpu_spread / 2, "%.2g"); }}};
}

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
    {"CPU", "s", [](const StudyRow& r) { return number(r.setup_cpu_seconds + r.cpu_seconds, "%.3g"); }},
    {"steps", "1", [=](const StudyRow& r) { return count(r.n_steps); }},
    {"steps/s", "1/s", [=](const StudyRow& r) { return number(steps_per_second(r), "%.1f"); }},
    {"memory", "MB", [](const StudyRow& r) { return number(r.peak_memory / 1e6, "%.0f"); }},
    {"iterations", "1", [=](const StudyRow& r) { return count(r.n_iterations); }},
    {"outcome", "", [](const StudyRow& r) { return r.outcome; }, true},
  };
}

std::vector<TextColumn> all_columns(const output::StudyTable& table) {
  std::vector<TextColumn> all = columns(table.unit);
  const auto insert_behind = [&](const std::string& name, const std::vector<TextColumn>& more) {
    const auto at = std::find_if(all.begin(), all.end(), [&](const TextColumn& c) { return c.name == name; });
    all.insert(at + 1, more.begin(), more.end());
  };
  insert_behind("order", error_columns(table));
  insert_behind("CPU", spread_columns(table));
  return all;
}

} // namespace

std::string aligned(const output::StudyTable& table) {
  const std::vector<TextColumn> all = all_columns(table);
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
