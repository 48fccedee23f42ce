#include "physics/narrowed.h"

#include "base/loan.h"
#include "dynamics/sound_steps.h"

namespace kerf::physics {

using dynamics::State;
using grid::CornerNumbers;

namespace {

/// A load on all corners, seen by some. It finds the others where they were.
class NarrowedLoad : public dynamics::Load {
 public:
  NarrowedLoad(const dynamics::Load& load, const State& state, const CornerNumbers& numbers)
    : load_(load), state_(state), numbers_(numbers) {}

  dynamics::Nature nature() const override { return load_.nature(); }
  double energy(const double time, const Points& x) const override { return load_.energy(time, *widened(x, state_.x)); }
  void add_force(const dynamics::Moment& moment, Points& forces) const override {
    const Loan<Vec3> x = widened(moment.x, state_.x), v = widened(moment.v, state_.v);
    Loan<Vec3> of_corners(x.size(), Vec3::Zero());
    load_.add_force({moment.time, *x, *v}, of_corners);
    for (std::size_t i = 0; i < numbers_.size(); ++i)
      forces[i] += of_corners[numbers_.corner(i)];
  }
  void add_tangent(const dynamics::Tangent kind, const dynamics::Moment& moment, const double velocity_factor,
                   dynamics::LoadTangent& tangent) const override {
    const Loan<Vec3> x = widened(moment.x, state_.x), v = widened(moment.v, state_.v);
    dynamics::LoadTangent by_corner;
    load_.add_tangent(kind, {moment.time, *x, *v}, velocity_factor, by_corner);
    tangent.add(by_corner, numbers_.numbers());
  }
  bool is_bounded_in_velocity() const override { return load_.is_bounded_in_velocity(); }

 private:
  Loan<Vec3> widened(const Points& of_numbers, const Points& others) const {
    Loan<Vec3> of_corners(others);
    numbers_.spread(of_numbers, *of_corners);
    return of_corners;
  }

  const dynamics::Load& load_;
  const State& state_;
  const CornerNumbers& numbers_;
};

void narrow(const State& wide, const CornerNumbers& numbers, State& state) {
  numbers.gather(wide.x, state.x);
  numbers.gather(wide.v, state.v);
  state.time = wide.time;
  state.numbers = wide.numbers;
  for (const auto& [name, values] : wide.history)
    if (values.size() == wide.x.size())
      numbers.gather(values, state.history[name]);
}

void widen(const State& state, const CornerNumbers& numbers, State& wide) {
  numbers.spread(state.x, wide.x);
  numbers.spread(state.v, wide.v);
  wide.time = state.time;
  wide.numbers = state.numbers;
  std::erase_if(wide.history, [&](const auto& known) { return state.history.count(known.first) == 0; });
  for (const auto& [name, values] : state.history) {
    Points& of_corners = wide.history[name];
    of_corners.resize(wide.x.size(), Vec3::Zero());
    numbers.spread(values, of_corners);
  }
}

} // namespace

dynamics::Loads narrowed(const dynamics::Loads& loads, const State& state, const CornerNumbers& numbers) {
  dynamics::Loads some{loads.gravity, loads.mass_damping, loads.stiffness_damping, {}};
  for (const dynamics::Support& support : loads.supports) {
    dynamics::Support& added =
      some.supports.emplace_back(dynamics::Support{{}, {}, support.displacement, support.rotation, support.held});
    for (std::size_t i = 0; i < support.corners.size(); ++i)
      if (numbers.counts(support.corners[i])) {
        added.corners.push_back(numbers[support.corners[i]]);
        added.rest.push_back(support.rest[i]);
      }
  }
  for (const auto& load : loads.acting)
    some.acting.push_back(std::make_unique<NarrowedLoad>(*load, state, numbers));
  return some;
}

dynamics::StepReport narrowed_step(dynamics::Stepper& stepper, const CornerNumbers& numbers, State& state,
                                   const dynamics::Loads& loads, const double dt) {
  State of_numbers;
  narrow(state, numbers, of_numbers);
  dynamics::StepReport report;
  try {
    report = stepper.step(of_numbers, narrowed(loads, state, numbers), dt);
  } catch (const dynamics::StepError& error) {
    throw dynamics::StepError(error.what(), numbers.corner(error.particle()));
  }
  widen(of_numbers, numbers, state);
  for (Points& shape : report.modes.shapes) {
    const Points by_number = std::move(shape);
    shape.assign(state.x.size(), Vec3::Zero());
    numbers.spread(by_number, shape);
  }
  return report;
}

} // namespace kerf::physics
