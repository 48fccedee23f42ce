#include "scene/grammar_output.h"

#include "scene/fields.h"
#include "scene/observables.h"

namespace kerf::scene {

namespace {

constexpr Range at_least_one{1, 1e9};

} // namespace

void OutputParameters::describe(Parameters& p) {
  p.integer("Frames every [1]", frames_every, at_least_one,
            "Steps between frames of corner positions and velocities in run.h5; its series have every step.");
  p.text("Fields", fields,
         "Fields over the body, separated by commas, for each corner in the frames of run.h5 and each vertex in the "
         "surface file: " +
           field_names() +
           ". Strain and stress are of the backend fem; modes, a field each (mode_1, ...), of the integrator modal. Or "
           "none.");
  p.number(
    "Checkpoint interval [s]", checkpoint_interval, non_negative,
    "Time on the clock between two checkpoints, from which --resume goes on after a kill; longer where they would "
    "take more than 1 % of the time. 0: only when a signal ends the run.");
  p.integer("Checkpoint every [1]", checkpoint_every, {0, 1e9},
            "Steps between two checkpoints, whatever the clock says. 0: by the clock.");
}

void SurfaceFileParameters::describe(Parameters& p) {
  p.integer("Every [1]", every, at_least_one, "Steps between two states in surface_BODY.vtkhdf.");
}

void ObservableParameters::describe(Parameters& p) {
  p.text("Names", names,
         "Quantities of every body to record at every step, separated by commas: " + observable_names() +
           ". 'kerf params' ends with their units and meanings.");
  p.require_last();
}

void ImageParameters::describe(Parameters& p) {
  p.integer("Every [1]", every, at_least_one, "Steps between two images.");
  p.integer("Width [1]", width, {16, 8192}, "Pixels.");
  p.integer("Height [1]", height, {16, 8192}, "Pixels.");
  p.vector("Eye [m]", eye, "Where the camera stands, world frame.");
  p.require_last();
  p.vector("Target [m]", target, "What the middle of the image shows.");
  p.require_last();
  p.vector("Up [1]", up, "Direction that is up in the image.");
  p.number("Field of view [degrees]", field_of_view, {.min = 1, .max = 150}, "Vertical opening angle.");
}

std::vector<SectionKind> output_kinds() {
  return {
    {"Output", Occurrence::once, "What run.h5 and the surface file hold.", keys_of<OutputParameters>(), {}},
    {"Observables",
     Occurrence::once,
     "Quantities over time in run.h5. Without this section there are none.",
     keys_of<ObservableParameters>(),
     {}},
    {"Surface file",
     Occurrence::once,
     "The surface as a time series for ParaView. Without this section there is none.",
     keys_of<SurfaceFileParameters>(),
     {}},
    {"Images",
     Occurrence::once,
     "PNG images. Without this section no graphics are started.",
     keys_of<ImageParameters>(),
     {}},
  };
}

} // namespace kerf::scene
