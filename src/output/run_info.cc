#include "output/run_info.h"

#include "base/error.h"
#include "output/names.h"

namespace kerf::output {

void write_info(const h5::Object& root, const RunInfo& info) {
  h5::set_attribute(root, "version", info.version);
  h5::set_attribute(root, "git_commit", info.git_commit);
  h5::set_attribute(root, "command_line", info.command_line);
  h5::set_attribute(root, "host", info.host);
  h5::set_attribute(root, "compiler", info.compiler);
  h5::set_attribute(root, "n_threads", static_cast<std::int64_t>(info.n_threads));
  h5::set_attribute(root, "seed", static_cast<std::int64_t>(info.seed));
  h5::set_attribute(root, "started", info.started);
  for (const auto& library : info.libraries)
    h5::set_attribute(root, library_prefix + library.name, library.version);
}

RunInfo read_info(const h5::Object& root) {
  const auto text = [&](const char* name) { return h5::text_attribute(root, name); };
  RunInfo info = {text("version"),
                  text("git_commit"),
                  text("command_line"),
                  text("host"),
                  text("compiler"),
                  {},
                  static_cast<int>(h5::integer_attribute(root, "n_threads")),
                  static_cast<std::uint64_t>(h5::integer_attribute(root, "seed")),
                  text("started")};
  const std::string prefix = library_prefix;
  for (const auto& name : h5::attribute_names(root))
    if (name.starts_with(prefix))
      info.libraries.push_back({name.substr(prefix.size()), h5::text_attribute(root, name)});
  return info;
}

Outcome read_outcome(const h5::Object& root) {
  const auto text = h5::text_attribute(root, "outcome");
  for (const auto outcome : {Outcome::running, Outcome::completed, Outcome::failed, Outcome::interrupted})
    if (text == to_string(outcome))
      return outcome;
  throw DataError({.file = root.file,
                   .path = "/outcome",
                   .value = text,
                   .rule = "must be running, completed, failed or interrupted",
                   .remedy = "Read a file that Kerf wrote"});
}

} // namespace kerf::output
