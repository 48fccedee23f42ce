#include "scene/compose_output.h"

#include "scene/fields.h"
#include "scene/text_suggest.h"

#include <algorithm>
#include <sstream>

namespace kerf::scene {

Images compose_images(const Section& section) {
  const auto parameters = section.read<ImageParameters>();
  const render::Camera camera{parameters.eye,           parameters.target, parameters.up,
                              parameters.field_of_view, parameters.width,  parameters.height};
  try {
    render::check(camera);
  } catch (const ParameterError& error) {
    throw placed(section, error.complaint().path.ends_with("up") ? "Up [1]" : "Eye [m]", error);
  }
  return {parameters.every, std::make_unique<render::Renderer>(camera, render::Look())};
}

namespace {

/// The words of a list separated by commas.
std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  std::istringstream text(list);
  for (std::string word; std::getline(text, word, ',');) {
    const auto first = word.find_first_not_of(" \t"), last = word.find_last_not_of(" \t");
    words.push_back(first == std::string::npos ? "" : word.substr(first, last - first + 1));
  }
  return words;
}

void require_known(const Section& section, const std::vector<std::string>& names) {
  const auto is_group = [](const std::string& name) {
    return std::any_of(observable_groups().begin(), observable_groups().end(),
                       [&](const ObservableGroup& group) { return group.name == name; });
  };
  for (auto it = names.begin(); it != names.end(); ++it) {
    if (!find_observable(*it) && !is_group(*it)) {
      std::vector<std::string> known;
      for (const Observable& one : body_observables())
        known.push_back(one.name);
      const auto meant = nearest(*it, known);
      throw section.complaint("Names", "'" + *it + "' is not an observable",
                              (meant ? "Did you mean '" + *meant + "'? " : "") +
                                "The observables and their units are listed by: kerf params");
    }
    if (std::find(names.begin(), it, *it) != it)
      throw section.complaint("Names", "'" + *it + "' is named twice", "Name it once");
  }
}

void require_fields(const Section& section, const World& world) {
  const auto& names = world.fields;
  for (auto it = names.begin(); it != names.end(); ++it) {
    if (!is_field(*it))
      throw section.complaint("Fields", "'" + *it + "' is not a field", "The fields are: " + field_names());
    if (std::find(names.begin(), it, *it) != it)
      throw section.complaint("Fields", "'" + *it + "' is named twice", "Name it once");
    for (const Body& body : world.bodies)
      if (!has_field(body, *it))
        throw *it == "modes"
          ? section.complaint("Fields",
                              "'modes' are known with the integrator modal of elements and springs only, and 'Body " +
                                body.name + "' has none",
                              "Remove it, or write 'set Integrator = modal' there")
          : section.complaint("Fields",
                              "'" + *it + "' is known of finite elements only, and 'Body " + body.name + "' has none",
                              "Remove it, or write 'set Backend = fem' there");
  }
}

} // namespace

void compose_output(const Section& section, World& world) {
  world.output = section.read<OutputParameters>();
  if (world.output.fields == "none")
    return;
  world.fields = words_of(world.output.fields);
  require_fields(section, world);
  world.composition.push_back("fields in the files: " + world.output.fields);
}

void compose_observables(const Section& section, World& world) {
  const auto names = words_of(section.read<ObservableParameters>().names);
  require_known(section, names);
  ToolNames tools;
  for (const Forceps& one : world.forceps)
    tools.forceps.push_back(one.name);
  for (const cut::Blade& blade : world.blades)
    tools.cuts.push_back(blade.name);
  for (const auto& [surface, step] : world.cut_surfaces)
    tools.cuts.push_back(surface.name);
  for (const std::string& name : names) {
    std::size_t n = 0;
    for (Body& body : world.bodies) {
      for (Observable& series : observables_named(name, body, tools)) {
        body.observables.push_back(std::move(series));
        ++n;
      }
      if (needs_accounts(name) && !body.accounts) {
        body.accounts = std::make_unique<Accounts>();
        body.accounts->open(*body.physics, body.loads, body.state);
      }
    }
    if (n == 0)
      throw section.complaint("Names", "'" + name + "' has nothing to report: the scene has none of what it is about",
                              name == "reactions"
                                ? "Remove it, or add a support that holds corners; one that holds the skin is a load: "
                                  "ask for 'load forces'"
                                : "Remove it, or add the support, forceps, cut, load, probe or crack front");
  }
}

} // namespace kerf::scene
