#include "scene/initial_state.h"

#include "dynamics/constraints.h"
#include "scene/expression.h"

namespace kerf::scene {

namespace {

/// The body has been here until now: nothing that was known of its motion holds.
void forget_motion(Body& body) {
  body.state.history.clear();
  body.state.numbers.clear();
  follow(body);
  if (body.cutter)
    body.cutter->stand(corners(body));
}

} // namespace

void InitialStateParameters::describe(Parameters& p) {
  p.text("Displacement [m]", displacement,
         "From rest, at time 0: three expressions of the rest position x, y, z, separated by semicolons. Supports hold "
         "what they hold. Surfaces that cut at time 0 cut the body at rest.");
  p.text("Velocity [m/s]", velocity, "At time 0: three expressions of the rest position x, y, z.");
}

InitialState compose_initial_state(const Section& section) {
  const auto parameters = section.read<InitialStateParameters>();
  return {vector_of_rest(section, "Displacement [m]", parameters.displacement),
          vector_of_rest(section, "Velocity [m/s]", parameters.velocity), 0};
}

void put_in_initial_state(Body& body, const double time_step) {
  if (!body.initial)
    return;
  const auto place = [&](const Vec3& X) { return Vec3(X + body.initial->displacement(X, 0)); };
  const auto velocity = [&](const Vec3& X) { return body.initial->velocity(X, 0); };
  const Points& rest = body.physics->rest();
  const auto held = dynamics::held_corners(body.loads, rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (!held[i]) {
      body.state.x[i] = place(rest[i]);
      body.state.v[i] = velocity(rest[i]);
    }
  if (body.physics->motion() == dynamics::MotionKind::dynamic) {
    const double delta = 0.5e-3 * time_step;
    dynamics::Constraints(body.loads, rest.size()).place_velocity(delta, delta, body.state.v);
  }
  if (body.physics->crumbs().any()) {
    physics::Motion now;
    for (const Vec3& X : grid::rest_positions(body.solid)) {
      now.x.push_back(place(X));
      now.v.push_back(velocity(X));
    }
    body.physics->crumbs().put(now, body.state);
  }
  forget_motion(body);
  body.initial->energy = inner_energy(*body.physics, body.state);
}

void put_at_rest(Body& body) {
  body.state = physics::state_at_rest(*body.physics);
  forget_motion(body);
}

} // namespace kerf::scene
