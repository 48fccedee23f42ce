#include "study/stability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

namespace kerf::study {

namespace {

using output::StabilityRow;

constexpr std::array<const char*, 7> outcomes = {"stable",  "damped out", "drifted", "not back",
                                                 "refused", "stopped",    "failed"};

template <class... Values>
std::string printed(const char* format, const Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

/// In the order of their first rows.
std::vector<std::pair<std::string, std::string>> sweeps_and_variants(const std::vector<StabilityRow>& rows) {
  std::vector<std::pair<std::string, std::string>> all;
  for (const StabilityRow& row : rows)
    if (const std::pair one(row.sweep, row.variant); std::find(all.begin(), all.end(), one) == all.end())
      all.push_back(one);
  return all;
}

std::string counts(const std::vector<StabilityRow>& rows) {
  std::string text = printed("%-24s %-28s", "sweep", "variant");
  for (const char* outcome : outcomes)
    text += printed(" %10s", outcome);
  text += "\n";
  for (const auto& [sweep, variant] : sweeps_and_variants(rows)) {
    text += printed("%-24s %-28s", sweep.c_str(), variant.c_str());
    for (const char* outcome : outcomes)
      text += printed(" %10td", std::count_if(rows.begin(), rows.end(), [&](const StabilityRow& row) {
                        return row.sweep == sweep && row.variant == variant && row.outcome == outcome;
                      }));
    text += "\n";
  }
  return text;
}

bool ended_well(const StabilityRow& row) { return row.outcome == "stable" || row.outcome == "damped out"; }

/// A line each.
std::string reasons(const std::vector<StabilityRow>& rows) {
  std::string text;
  for (const StabilityRow& row : rows)
    if (!ended_well(row))
      text += row.sweep + ", " + row.variant + ", " + row.cases + ": " + row.outcome +
              (row.reason.empty() ? "" : ": " + row.reason) + "\n";
  return text;
}

std::string steps(const std::vector<StabilityRow>& rows) {
  std::string text;
  for (const StabilityRow& row : rows)
    if (!std::isnan(row.largest_step))
      text +=
        printed("%-24s %-28s %-28s predicted %9.3g s, found %9.3g s, %.3f\n", row.sweep.c_str(), row.variant.c_str(),
                row.cases.c_str(), row.predicted_step, row.largest_step, row.largest_step / row.predicted_step);
  return text;
}

} // namespace

std::string aligned(const output::StabilityTable& table) {
  std::string text = counts(table.rows);
  if (const std::string found = steps(table.rows); !found.empty())
    text += "\nlargest steps\n" + found;
  if (const std::string others = reasons(table.rows); !others.empty())
    text += "\nwhat did not go on\n" + others;
  return text;
}

} // namespace kerf::study
