#include "study/grammar.h"

#include "study/closed_form.h"
#include "study/reference_file.h"
#include "study/truth.h"

namespace kerf::study {

using scene::keys_of;
using scene::Occurrence;

void AnswerParameters::describe(Parameters& p) {
  p.text("Answer", answer, "A series that the scene's observables record, such as 'probe tip z'.");
  p.require_last();
  p.text("Minus", minus, "A series that is subtracted from it. Empty: none.");
  p.choice("Take", take, {"end", "maximum", "minimum", "mean of the last part", "frequency"},
           "The number that stands for the series. Frequency: of its passages upwards through its mean, in 1/s.");
  p.number("Last part [1]", last_part, {.min = 0, .max = 1, .min_excluded = true},
           "Part of the run's duration, at its end, that the mean is taken over.");
  p.text("Unit", unit, "Of the answer and its references; must be that of the series, and 1/s or Hz for a frequency.");
  p.require_last();
}

void StudyParameters::describe(Parameters& p) {
  p.text("Title", title, "What is asked, in a sentence.");
  p.file("Scene", scene,
         "The scene that all rows run, relative to this file. Its images and surface files are left out.");
  p.require_last();
  p.text("Body", body, "The body that is asked. Empty: the first of the scene.");
  AnswerParameters::describe(p);
  p.text("Order over", order_over,
         "The change whose cases differ in h, or in the time step: orders of convergence are told between rows that "
         "differ in it alone.");
  p.text("Reference row", reference_row,
         "The row that those without another reference are measured by: its name as tables have it, 'fem, 7', or "
         "'finest': of the rows that orders are told between the one with the smallest h, or time step.");
  p.choice("Times", times, {"count", "do not count"},
           "Rows whose times count run one at a time, whatever --jobs says, so that none is beside another. Those of "
           "rows that do not are unknown.");
  p.integer("Repetitions", repetitions, {.min = 1, .max = 1000},
            "How often each row is run, one after the other. Its times are medians, and their spread is told; all else "
            "must be the same bit by bit, or the row has failed.");
}

void NormParameters::describe(Parameters& p) {
  AnswerParameters::describe(p);
  p.choice("Truth", truth, {"none", "elastic energy", "lowest frequency"},
           "What of the section Truth is its reference, where it has no other.");
}

void PointsParameters::describe(Parameters& p) {
  p.points("Points [m]", points, "Of the material at rest: x, y, z; x, y, z.");
  p.points("Box [m]", box, "Two opposite corners of a grid of points: x, y, z; x, y, z.");
  p.numbers("Counts [1]", counts, {.min = 1}, "Points of the grid along x, y, z; a single one lies in the middle.");
}

void ReferenceParameters::describe(Parameters& p) {
  p.number("Reference", reference, any_number,
           "What the answer should be, in its unit; errors are value over reference less one. 0: what stands above it "
           "says; the reference of a case counts before that of a variant, and that before the study's.");
  p.text("Reference source", source, "Where the reference comes from: a formula, a table, a finer computation.");
}

void SettingParameters::describe(Parameters& p) {
  p.text("Set", set,
         "Changes of the scene, separated by '|': Section/Key=value | Section/Key=value, as --set has them.");
}

void RangeParameters::describe(Parameters& p) {
  p.text(
    "Key", key,
    "What takes the values below, as Section/Key: Body bar/Integrator. Several keys, separated by '|', take the same.");
  p.text("Values", values, "Its values, separated by '|': implicit Euler | Newmark. Each is a case of that name.");
  p.numbers("Range", range, any_number, "Instead of values: the first and the last of several numbers.");
  p.integer("Number [1]", number, {.min = 0, .max = 1000}, "How many numbers the range has.");
  p.choice("Spacing", spacing, {"equal steps", "equal ratios"}, "How the numbers of the range follow each other.");
}

std::vector<scene::SectionKind> grammar() {
  return {{"Study", Occurrence::once, "What is run and asked.", keys_of<StudyParameters, ReferenceParameters>(), {}},
          truth_grammar(),
          closed_form_grammar(),
          reference_file_grammar(),
          {"Norm",
           Occurrence::titled,
           "A further number that is asked of each row, such as an energy, a frequency or the opening of a crack, with "
           "an error "
           "of its own.",
           keys_of<NormParameters, ReferenceParameters>(),
           {}},
          {"Points",
           Occurrence::once,
           "Points of the material where the displacement at the end is compared with that of the reference, a section "
           "Truth or "
           "a row: relative errors in the L2 norm and at most.",
           keys_of<PointsParameters>(),
           {}},
          {"Variant",
           Occurrence::titled,
           "One way to run the scene.",
           keys_of<SettingParameters, ReferenceParameters>(),
           {truth_grammar(), closed_form_grammar(), reference_file_grammar()}},
          {"Change",
           Occurrence::titled,
           "Cases that every variant is run in; several changes make a grid. Without this section there is one row a "
           "variant. Its values are cases too.",
           keys_of<RangeParameters>(),
           {{"Case",
             Occurrence::titled,
             "One case of the change.",
             keys_of<SettingParameters, ReferenceParameters>(),
             {truth_grammar(), closed_form_grammar(), reference_file_grammar()}}}}};
}

} // namespace kerf::study
