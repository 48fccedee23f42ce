#include "scene/compose_output.h"

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

std::vector<const BodyObservable*> compose_observables(const Section& section) {
  const auto parameters = section.read<ObservableParameters>();
  std::vector<const BodyObservable*> chosen;
  std::istringstream names(parameters.names);
  for (std::string name; std::getline(names, name, ',');) {
    const auto first = name.find_first_not_of(" \t"), last = name.find_last_not_of(" \t");
    const std::string word = first == std::string::npos ? "" : name.substr(first, last - first + 1);
    const BodyObservable* observable = find_observable(word);
    if (!observable)
      throw section.complaint("Names", "'" + word + "' is not an observable",
                              "The observables and their units are listed by: kerf params");
    if (std::find(chosen.begin(), chosen.end(), observable) != chosen.end())
      throw section.complaint("Names", "'" + word + "' is named twice", "Name it once");
    chosen.push_back(observable);
  }
  return chosen;
}

} // namespace kerf::scene
