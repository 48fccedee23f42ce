/// What a user would take instead, on the heavy cantilever: error against time, all in one run on one thread.

#include "base/parallel.h"
#include "tests/verification/beams.h"
#include "tests/verification/calculix.h"
#include "tests/verification/ngsolve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <sys/resource.h>

namespace kerf::verification::peers_test {
namespace {

/// CPU seconds of the processes that this one has waited for [s].
double seconds_of_children() {
  rusage use;
  getrusage(RUSAGE_CHILDREN, &use);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(use.ru_utime) + seconds(use.ru_stime);
}

struct Answer {
  double tip, seconds;
};

/// The answer in the median time of three.
Answer median(const std::function<Answer()>& ask) {
  std::vector<Answer> all;
  for (int i = 0; i < 3; ++i)
    all.push_back(ask());
  std::sort(all.begin(), all.end(), [](const Answer& a, const Answer& b) { return a.seconds < b.seconds; });
  return all[1];
}

Answer ours(const int n, const fem::Strain strain) {
  const BeamResult r = heavy_cantilever(n, Vec3::Zero(), {.strain = strain});
  return {r.value, r.cost.total()};
}

/// The whole process: it reads its input and writes its output, too.
Answer calculix(const int n, const calculix::Element element) {
  const double before = seconds_of_children();
  const double tip = calculix::heavy_cantilever(n, element);
  return {tip, seconds_of_children() - before};
}

Answer ngsolve(const int n, const int order) {
  const ngsolve::Tip found = ngsolve::heavy_cantilever(n, order);
  return {found.value, found.seconds};
}

/// Prints a row and returns the error [1].
double row(const char* name, const int n, const std::function<Answer()>& ask) {
  const Answer a = median(ask);
  const double error = a.tip / heavy_cantilever_reference - 1;
  std::printf("| %s | %d | %+.3f | %.4f |\n", name, n, 100 * error, a.seconds);
  std::fflush(stdout);
  testing::Test::RecordProperty(std::string(name) + ", " + std::to_string(n),
                                std::to_string(100 * error) + " %, " + std::to_string(a.seconds) + " s");
  return error;
}

class Peers : public testing::Test {
 protected:
  void SetUp() override { set_n_threads(1); }
  void TearDown() override { set_n_threads(n_threads_); }

 private:
  int n_threads_ = n_threads();
};

/// Elements of the same kind give the same tip: trilinear ones in all three programs, and incompatible modes are off by
/// as much as enhanced strain to a hundredth of a percent; all converge from the stiff side. Times are printed.
TEST_F(Peers, OnTheHeavyCantilever) {
  std::printf("\n| heavy cantilever | cells over the height | error of the tip [%%] | CPU [s] |\n|---|---|---|---|\n");
  std::vector<double> trilinear, enhanced;
  for (const int n : {2, 4, 8, 16}) {
    if (n < 16)
      trilinear.push_back(row("Kerf, trilinear", n, [n] { return ours(n, fem::Strain::trilinear); }));
    enhanced.push_back(row("Kerf, enhanced", n, [n] { return ours(n, fem::Strain::enhanced); }));
    if (n > 2) {
      EXPECT_LT(std::abs(enhanced.back()), 0.5 * std::abs(enhanced[enhanced.size() - 2]));
    }
  }
  if (calculix::is_installed()) {
    for (int i = 0; i < 3; ++i) {
      const int n = 2 << i;
      EXPECT_NEAR(row("CalculiX C3D8", n, [n] { return calculix(n, calculix::Element::C3D8); }), trilinear[i], 2e-6);
      EXPECT_NEAR(row("CalculiX C3D8I", n, [n] { return calculix(n, calculix::Element::C3D8I); }), enhanced[i], 1e-3);
    }
    for (const int n : {2, 4})
      EXPECT_LT(row("CalculiX C3D20R", n, [n] { return calculix(n, calculix::Element::C3D20R); }), 0) << n;
  } else
    std::printf("CalculiX is not installed (Debian package calculix-ccx)\n");
  if (ngsolve::is_installed()) {
    for (int i = 0; i < 2; ++i) {
      const int n = 2 << i;
      EXPECT_NEAR(row("NGSolve, order 1", n, [n] { return ngsolve(n, 1); }), trilinear[i], 2e-6);
      EXPECT_LT(row("NGSolve, order 2", n, [n] { return ngsolve(n, 2); }), 0) << n;
      EXPECT_LT(row("NGSolve, order 3", n, [n] { return ngsolve(n, 3); }), 0) << n;
    }
  } else
    std::printf("NGSolve is not installed (pip install ngsolve, for the python3 of PATH)\n");
}

} // namespace
} // namespace kerf::verification::peers_test
