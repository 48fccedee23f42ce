#include "scene_arguments.h"

#include "base/error.h"

#include <charconv>

namespace kerf::apps {

namespace {

int parse_threads(const std::string& text) {
  int n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc() || end != text.data() + text.size() || n < 1 || n > 1024)
    throw ParameterError(
      Complaint{.path = "--threads", .value = text, .rule = "must be a whole number from 1 to 1024"});
  return n;
}

} // namespace

SceneArguments parse_scene_arguments(const Arguments& arguments) {
  SceneArguments parsed;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    const auto value = [&]() -> const std::string& {
      if (i + 1 == arguments.size())
        throw ParameterError(Complaint{.path = argument, .rule = "needs a value after it"});
      return arguments[++i];
    };
    if (argument == "--set")
      parsed.overrides.push_back(value());
    else if (argument == "--output")
      parsed.output = value();
    else if (argument == "--threads")
      parsed.n_threads = parse_threads(value());
    else if (argument.starts_with("-"))
      throw ParameterError(Complaint{
        .value = argument, .rule = "is no option", .remedy = "The options are --set, --output and --threads"});
    else if (parsed.scene.empty())
      parsed.scene = argument;
    else
      throw ParameterError(Complaint{
        .value = argument, .rule = "only one scene can be given", .remedy = "Put quotes around arguments with spaces"});
  }
  if (parsed.scene.empty())
    throw ParameterError(Complaint{.rule = "a scene file must be given", .remedy = "For example: params/liver.prm"});
  if (parsed.output.empty())
    parsed.output = std::filesystem::path("results") / std::filesystem::path(parsed.scene).stem();
  return parsed;
}

} // namespace kerf::apps
