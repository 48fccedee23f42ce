#include "tests/verification/statics.h"

#include <algorithm>

namespace kerf::verification {

Built build(const std::function<Body()>& make_body, const fem::HexahedraOptions& options) {
  const CpuTimer timer;
  Built built{make_body(), nullptr, {}};
  built.cost.body = timer.seconds();
  built.model = std::make_unique<fem::Hexahedra>(built.body, options);
  built.cost.elements = timer.seconds() - built.cost.body;
  return built;
}

double NodalForces::energy(double, const Points& x) const {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    sum -= forces_[i].dot(x[i]);
  return sum;
}

void NodalForces::add_force(const dynamics::Moment&, Points& forces) const {
  for (std::size_t i = 0; i < forces.size(); ++i)
    forces[i] += forces_[i];
}

dynamics::Support hold(const Points& rest, const std::vector<std::uint32_t>& corners, const Mat3& held) {
  dynamics::Support support{corners, {}, [](double) { return Vec3(Vec3::Zero()); }, {}, held};
  for (const auto c : corners)
    support.rest.push_back(rest[c]);
  return support;
}

Points displacements(const Body& body, fem::Hexahedra& model, Points forces, std::vector<dynamics::Support> supports,
                     const LinearSolver solver) {
  dynamics::Loads loads;
  loads.supports = std::move(supports);
  loads.acting.push_back(std::make_unique<NodalForces>(std::move(forces)));
  dynamics::QuasiStaticOptions options{.free_modes = dynamics::FreeModes::allow};
  options.newton.solver = solver;
  options.newton.tangent = dynamics::Tangent::exact;
  options.newton.cg_tolerance = 1e-9;
  const Points rest = body.rest();
  dynamics::State state{rest, Points(rest.size(), Vec3::Zero()), 0};
  dynamics::QuasiStatic(model, options).step(state, loads, 1);
  for (std::size_t c = 0; c < rest.size(); ++c)
    state.x[c] -= rest[c];
  return state.x;
}

Points deformed(const Body& body, const Points& u) {
  Points x = body.rest();
  for (std::size_t c = 0; c < x.size(); ++c)
    x[c] += u[c];
  return x;
}

std::vector<dynamics::Support> hold_rigid_motion(const Points& rest) {
  const auto farthest = [&](const auto& distance) {
    std::uint32_t best = 0;
    for (std::uint32_t c = 1; c < rest.size(); ++c)
      if (distance(rest[c]) > distance(rest[best]))
        best = c;
    return best;
  };
  const Vec3 middle = 0.5 * (rest.front() + rest.back());
  const auto a = farthest([&](const Vec3& X) { return -(X - middle).norm(); });
  const auto b = farthest([&](const Vec3& X) { return X[0] - (X - rest[a]).tail<2>().norm(); });
  const auto c =
    farthest([&](const Vec3& X) { return X[1] - std::abs(X[0] - rest[a][0]) - std::abs(X[2] - rest[a][2]); });
  return {hold(rest, {a}), hold(rest, {b}, dynamics::held_axes("yz")), hold(rest, {c}, dynamics::held_axes("z"))};
}

fem::HexahedraOptions hooke(const double youngs_modulus, const double nu, const fem::Strain strain,
                            const fem::Boundary boundary, const double ghost_weight) {
  return {.material = {.density = 1000, .youngs_modulus = youngs_modulus, .poissons_ratio = nu, .law = "small strain"},
          .boundary = boundary,
          .strain = strain,
          .ghost_penalty = {.weight = ghost_weight}};
}

} // namespace kerf::verification
