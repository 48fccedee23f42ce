#include "scene_arguments.h"

#include "base/error.h"

#include <algorithm>
#include <charconv>

namespace kerf::apps {

namespace {

int parse_number(const std::string& option, const std::string& text) {
  int n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc() || end != text.data() + text.size() || n < 1 || n > 1024)
    throw ParameterError(Complaint{.path = option, .value = text, .rule = "must be a whole number from 1 to 1024"});
  return n;
}

/// An empty name comes of a variable that a script has not set: results would go where they are not looked for.
std::filesystem::path folder_named(const std::string& name) {
  if (name.empty())
    throw ParameterError(Complaint{.path = "--output",
                                   .rule = "must name a folder",
                                   .remedy = "Leave it out for results/SCENE"});
  return name;
}

void add_scene(const std::string& scene, const Scenes scenes, SceneArguments& parsed) {
  if (!parsed.scenes.empty() && scenes != Scenes::several)
    throw ParameterError(Complaint{
      .value = scene, .rule = "only one scene can be given", .remedy = "Put quotes around arguments with spaces"});
  parsed.scenes.push_back(scene);
}

void set_earlier(const std::string& option, SceneArguments& parsed) {
  const auto wanted = option == "--force" ? output::Earlier::replace : output::Earlier::resume;
  if (parsed.earlier != output::Earlier::refuse && parsed.earlier != wanted)
    throw ParameterError(Complaint{.value = option,
                                   .rule = "--force and --resume exclude each other",
                                   .remedy = "--force begins anew, --resume goes on from what there is"});
  parsed.earlier = wanted;
}

} // namespace

std::filesystem::path default_output(const std::string& scene, const std::filesystem::path& folder) {
  return folder / std::filesystem::path(scene).stem();
}

SceneArguments parse_scene_arguments(const Arguments& arguments, const Scenes scenes) {
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
      parsed.output = folder_named(value());
    else if (argument == "--threads")
      parsed.n_threads = parse_number(argument, value());
    else if (argument == "--jobs" && scenes != Scenes::one)
      parsed.n_jobs = parse_number(argument, value());
    else if (argument == "--row" && scenes == Scenes::study)
      parsed.row = parse_number(argument, value());
    else if (argument == "--force" || argument == "--resume")
      set_earlier(argument, parsed);
    else if (argument.starts_with("-"))
      throw ParameterError(Complaint{.value = argument,
                                     .rule = "is no option",
                                     .remedy = "The options are --set, --output, --threads, --force, --resume, --jobs "
                                               "of run and study, and --row of study"});
    else
      add_scene(argument, scenes, parsed);
  }
  if (parsed.scenes.empty())
    throw ParameterError(Complaint{.rule = "a scene file must be given", .remedy = "For example: params/liver.prm"});
  parsed.scene = parsed.scenes.front();
  if (parsed.output.empty())
    parsed.output = parsed.scenes.size() == 1 ? default_output(parsed.scene) : "results";
  return parsed;
}

scene::SceneText read_text(const SceneArguments& arguments, const Scenes scenes) {
  scene::SceneText text = scene::read_scene_text(arguments.scene, arguments.overrides);
  const auto& sections = text.root.sections;
  const auto is_of_a_study = [](const scene::WrittenSection& s) {
    return s.heading == "Study" || s.heading == "Stability";
  };
  const auto is_of_a_scene = [](const scene::WrittenSection& s) { return s.heading.starts_with("Body "); };
  const auto title = std::ranges::find_if(sections, is_of_a_study),
             body = std::ranges::find_if(sections, is_of_a_scene);
  const auto complain = [&](const scene::WrittenSection& section, const std::string& rule, const std::string& command) {
    throw ParameterError(Complaint{section.origin.file, section.origin.line, section.heading, "", rule,
                                   "Run it with: kerf " + command + ' ' + arguments.scene});
  };
  if (scenes != Scenes::study && title != sections.end())
    complain(*title, "this is a study, not a scene", "study");
  if (scenes == Scenes::study && title == sections.end() && body != sections.end())
    complain(*body, "this is a scene, not a study", "run");
  return text;
}

void add_common(const SceneArguments& arguments, std::vector<std::string>& words) {
  for (const std::string& change : arguments.overrides) {
    words.emplace_back("--set");
    words.push_back(change);
  }
  if (arguments.earlier != output::Earlier::refuse)
    words.emplace_back(arguments.earlier == output::Earlier::replace ? "--force" : "--resume");
}

} // namespace kerf::apps
