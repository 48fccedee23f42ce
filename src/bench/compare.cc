#include "bench/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace kerf::bench {

namespace {

std::string percent(const double part) {
  if (std::isnan(part))
    return "-";
  std::array<char, 16> text;
  std::snprintf(text.data(), text.size(), "%.0f %%", 100 * part);
  return text.data();
}

template <class... Values>
std::string printed(const char* const format, const Values... values) {
  std::array<char, 240> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

} // namespace

std::string heading() {
  return printed("%-32s %9s %10s %-9s %11s %7s %11s %7s %9s", "path", "cells", "n", "of", "ms a call", "spread", "n/s",
                 "peak", "bandwidth");
}

std::string line_of(const output::BenchRow& row) {
  return printed("%-32s %9lld %10lld %-9s %11.4f %7s %11.3g %7s %9s", row.path.c_str(),
                 static_cast<long long>(row.cells), static_cast<long long>(row.n), row.item.c_str(), 1e3 * row.seconds,
                 percent(row.spread).c_str(), row.rate, percent(row.of_peak).c_str(),
                 percent(row.of_bandwidth).c_str());
}

Comparison compare(const output::BenchTable& now, const output::BenchTable& before, const double allowed) {
  Comparison result;
  for (const output::BenchRow& old : before.rows) {
    const auto it = std::find_if(now.rows.begin(), now.rows.end(), [&](const output::BenchRow& row) {
      return row.path == old.path && row.cells == old.cells;
    });
    const std::string where = old.path + ", " + std::to_string(old.cells) + " cells";
    if (it == now.rows.end()) {
      result.missing.push_back(where);
      continue;
    }
    ++result.n_compared;
    const double noise = std::max(it->spread, old.spread);
    if (it->rate < (1 - std::max(allowed, noise)) * old.rate)
      result.fallen.push_back(printed("%s: %.3g %s/s, %.0f %% less than %.3g", where.c_str(), it->rate,
                                      old.item.c_str(), 100 * (1 - it->rate / old.rate), old.rate));
  }
  return result;
}

} // namespace kerf::bench
