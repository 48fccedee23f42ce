#pragma once

/// Static problems by the program's own solvers, and how long they take.

#include "dynamics/quasi_static.h"
#include "tests/verification/body.h"

#include <ctime>
#include <memory>

namespace kerf::verification {

/// CPU seconds of this process since it was made, all threads.
class CpuTimer {
 public:
  double seconds() const { return now() - start_; }

 private:
  static double now() {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  double start_ = now();
};

/// CPU seconds of the parts of a run [s].
struct Cost {
  double body = 0, elements = 0, solution = 0;
  double total() const { return body + elements + solution; }
};

/// A body and its elements, with what they cost.
struct Built {
  Body body;
  std::unique_ptr<fem::Hexahedra> model;
  Cost cost;
};
Built build(const std::function<Body()>& make_body, const fem::HexahedraOptions& options);

/// Forces on corners that never change [N].
class NodalForces : public dynamics::Load {
 public:
  explicit NodalForces(Points forces) : forces_(std::move(forces)) {}

  dynamics::Nature nature() const override { return dynamics::Nature::conservative; }
  double energy(double time, const Points& x) const override;
  void add_force(const dynamics::Moment& moment, Points& forces) const override;
  void add_tangent(dynamics::Tangent, const dynamics::Moment&, double, dynamics::LoadTangent&) const override {}

 private:
  Points forces_;
};

/// Corners that stay where they are along the directions of `held`.
dynamics::Support hold(const Points& rest, const std::vector<std::uint32_t>& corners,
                       const Mat3& held = Mat3::Identity());

using dynamics::LinearSolver;

/// Displacements under dead forces on the corners; linear where the law is.
Points displacements(const Body& body, fem::Hexahedra& model, Points forces, std::vector<dynamics::Support> supports,
                     LinearSolver solver);

/// Where the corners are.
Points deformed(const Body& body, const Points& u);

/// Holds three corners in six directions, against rigid motion and no more.
std::vector<dynamics::Support> hold_rigid_motion(const Points& rest);

fem::HexahedraOptions hooke(double youngs_modulus, double nu, fem::Strain strain = fem::Strain::enhanced,
                            fem::Boundary boundary = fem::Boundary::octants,
                            double ghost_weight = fem::GhostPenaltyOptions().weight);

} // namespace kerf::verification
