#include "run_info.h"

#include "base/parallel.h"
#include "scene/build_info.h"

#include <array>
#include <ctime>

#include <unistd.h>

namespace kerf::apps {

output::RunInfo run_info(const std::string& command, const Arguments& arguments) {
  output::RunInfo info = scene::build_info();
  info.command_line = "kerf " + command;
  for (const std::string& argument : arguments)
    info.command_line += argument.find(' ') == std::string::npos ? " " + argument : " \"" + argument + "\"";
  std::array<char, 256> text{};
  gethostname(text.data(), text.size() - 1);
  info.host = text.data();
  info.n_threads = n_threads();
  const std::time_t now = std::time(nullptr);
  std::strftime(text.data(), text.size(), "%FT%TZ", std::gmtime(&now));
  info.started = text.data();
  return info;
}

} // namespace kerf::apps
