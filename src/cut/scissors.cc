#include "cut/scissors.h"

#include "base/error.h"
#include "base/parameters.h"

namespace kerf::cut {
namespace {

Hinge hinge(const Scissors& scissors, const double share) {
  Hinge hinge{scissors.pivot, scissors.axis, {}};
  for (const AngleFrame& opening : scissors.openings)
    hinge.angles.push_back({opening.time, share * opening.angle});
  return hinge;
}

void check_openings(const Scissors& scissors) {
  for (const AngleFrame& opening : scissors.openings)
    if (!(opening.angle >= 0 && opening.angle < 180))
      throw ParameterError(Complaint{.path = "Scissors " + scissors.name + "/Angles",
                                     .value = to_text(opening.angle) + " degrees at " + to_text(opening.time) + " s",
                                     .rule = "must be >= 0 and < 180",
                                     .remedy = "Write the angle between the blades: 0 when they are closed"});
}

} // namespace

std::array<Blade, 2> blades(const Scissors& scissors, const grid::CutLabel label) {
  check_openings(scissors);
  std::array<Blade, 2> both;
  for (int i = 0; i < 2; ++i) {
    both[i] = {.name = scissors.name + (i == 0 ? " first" : " second"),
               .edge = scissors.edges[i],
               .key_frames = scissors.key_frames,
               .label = static_cast<grid::CutLabel>(label + i),
               .spine = scissors.spines[i],
               .hinge = hinge(scissors, i == 0 ? 0.5 : -0.5)};
    check(both[i]);
  }
  return both;
}

} // namespace kerf::cut
