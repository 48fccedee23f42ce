#include "scene/grammar.h"

namespace kerf::scene {

void TimeParameters::describe(Parameters& p) {
  p.number("Time step [s]", time_step, positive, "Length of every step.");
  p.number("End time [s]", end_time, positive, "The run takes round(end time / time step) steps from time 0.");
}

void GravityParameters::describe(Parameters& p) {
  p.vector("Acceleration [m/s^2]", acceleration,
           "Acts on every body, world frame. Without this section there is none.");
}

std::vector<SectionKind> grammar() {
  std::vector<SectionKind> kinds = {
    {"Time", Occurrence::once, "Steps of the run.", keys_of<TimeParameters>(), {}},
    {"Gravity", Occurrence::once, "A uniform field.", keys_of<GravityParameters>(), {}},
  };
  for (const auto& part : {body_kinds(), tool_kinds(), output_kinds()})
    kinds.insert(kinds.end(), part.begin(), part.end());
  return kinds;
}

} // namespace kerf::scene
