#include "commands.h"

#include "base/error.h"
#include "scene/grammar.h"
#include "scene/text_print.h"

#include <cstdio>

namespace kerf::apps {

int params(const Arguments& arguments) {
  if (!arguments.empty())
    throw ParameterError(Complaint{.value = arguments[0], .rule = "params takes no arguments"});
  std::printf("%s", scene::print_parameters(scene::grammar()).c_str());
  return 0;
}

} // namespace kerf::apps
