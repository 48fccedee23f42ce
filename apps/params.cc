#include "commands.h"

#include "base/error.h"
#include "scene/grammar.h"
#include "scene/text_print.h"
#include "study/grammar.h"

#include <cstdio>

namespace kerf::apps {

int params(const Arguments& arguments) {
  const bool of_studies = arguments == Arguments{"study"};
  if (!arguments.empty() && !of_studies)
    throw ParameterError(Complaint{.value = arguments[0], .rule = "params takes no arguments but 'study'"});
  const std::string page = of_studies ? scene::print_parameters(study::grammar())
                                      : scene::print_parameters(scene::grammar()) + "\n" + scene::print_observables();
  std::printf("%s", page.c_str());
  return 0;
}

} // namespace kerf::apps
