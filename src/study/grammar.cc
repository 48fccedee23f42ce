#include "study/grammar.h"

#include "study/truth.h"

namespace kerf::study {

using scene::keys_of;
using scene::Occurrence;

void StudyParameters::describe(Parameters& p) {
  p.text("Title", title, "What is asked, in a sentence.");
  p.file("Scene", scene,
         "The scene that all rows run, relative to this file. Its images and surface files are left out.");
  p.require_last();
  p.text("Body", body, "The body that is asked. Empty: the first of the scene.");
  p.text("Answer", answer, "A series that the scene's observables record, such as 'probe tip z'.");
  p.require_last();
  p.text("Minus", minus, "A series that is subtracted from it. Empty: none.");
  p.choice("Take", take, {"end", "maximum", "minimum", "mean of the last part"},
           "The number that stands for the series.");
  p.number("Last part [1]", last_part, {.min = 0, .max = 1, .min_excluded = true},
           "Part of the run's duration, at its end, that the mean is taken over.");
  p.text("Unit", unit, "Of the answer and its references; must be that of the series.");
  p.require_last();
  p.text("Order over", order_over,
         "The change whose cases differ in h: orders of convergence are told between rows that differ in it alone.");
  p.choice("Times", times, {"count", "do not count"},
           "Rows whose times count run one at a time, whatever --jobs says, so that none is beside another. Those of "
           "rows that "
           "do not are unknown.");
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

std::vector<scene::SectionKind> grammar() {
  return {
    {"Study", Occurrence::once, "What is run and asked.", keys_of<StudyParameters, ReferenceParameters>(), {}},
    truth_grammar(),
    {"Variant", Occurrence::named, "One way to run the scene.", keys_of<SettingParameters, ReferenceParameters>(), {}},
    {"Change",
     Occurrence::named,
     "Cases that every variant is run in; several changes make a grid. Without this section there is one row a "
     "variant.",
     {},
     {{"Case", Occurrence::named, "One case of the change.", keys_of<SettingParameters, ReferenceParameters>(), {}}}}};
}

} // namespace kerf::study
