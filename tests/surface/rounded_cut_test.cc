/// Curved cut surfaces inside a body: second order in h, in volume and in area.

#include "tests/support/rounded.h"

#include <gtest/gtest.h>

#include <iostream>

namespace kerf::surface::rounded_cut_test {
namespace {

const std::vector<double> spacings = {1.0 / 8, 1.0 / 12, 1.0 / 18, 1.0 / 27, 1.0 / 40};

/// The slope of the least-squares line through (log h, log error) of the last ones: the first of a cylinder are better
/// than the order promises.
double rate(const std::vector<double>& errors) {
  constexpr std::size_t n_last = 3;
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = errors.size() - n_last; i < errors.size(); ++i) {
    const double x = std::log(spacings[i]), y = std::log(errors[i]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const double n = n_last;
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

TEST(RoundedCut, IsOfSecondOrder) {
  for (const support::RoundCut& round : support::round_cuts()) {
    std::vector<double> volumes, areas;
    for (const double h : spacings) {
      const support::CutErrors errors = support::mean_errors(round, h, 4);
      volumes.push_back(errors.volume);
      areas.push_back(errors.area);
    }
    std::cout << round.name << ": volume error " << volumes.front() << " to " << volumes.back() << ", rate "
              << rate(volumes) << "; area error " << areas.front() << " to " << areas.back() << ", rate " << rate(areas)
              << '\n';
    EXPECT_GT(rate(volumes), 1.8) << round.name;
    EXPECT_LT(volumes.back(), 1e-2) << round.name;
    // An edge that passes a sharp rim twice is left whole: chamfers of a fraction of a cell, of first order in area.
    const bool is_smooth = round.name != std::string("with rims");
    EXPECT_GT(rate(areas), is_smooth ? 1.8 : 0.9) << round.name;
  }
}

} // namespace
} // namespace kerf::surface::rounded_cut_test
