#include "scene/fields.h"

#include "fem/fields.h"
#include "physics/on_corners.h"

#include <algorithm>
#include <array>

namespace kerf::scene {

namespace {

struct Kind {
  const char *name, *dataset, *unit;
  std::size_t n_components;
};
constexpr std::array<Kind, 5> kinds = {{{"displacement", "displacement", "m", 3},
                                        {"strain", "strain", "1", 6},
                                        {"stress", "stress", "Pa", 6},
                                        {"von Mises stress", "von_mises_stress", "Pa", 1},
                                        {"modes", "mode_", "1", 3}}};

const Kind* find_kind(const std::string& name) {
  const auto it = std::find_if(kinds.begin(), kinds.end(), [&](const Kind& kind) { return kind.name == name; });
  return it == kinds.end() ? nullptr : &*it;
}

const physics::Elements* elements_of(const Body& body) {
  return dynamic_cast<const physics::Elements*>(body.physics.get());
}

void append(const Mat3& tensor, std::vector<double>& values) {
  constexpr std::array<std::array<int, 2>, 6> components = {{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};
  for (const auto& [row, column] : components)
    values.push_back(tensor(row, column));
}

std::vector<double> displacements(const Body& body) {
  const Points rest = grid::rest_positions(body.solid);
  std::vector<double> values;
  for (std::size_t c = 0; c < rest.size(); ++c)
    for (int axis = 0; axis < 3; ++axis)
      values.push_back(corners(body)[c][axis] - rest[c][axis]);
  return values;
}

/// Of a mode; none before the first step.
std::vector<double> shape_of(const Body& body, const std::size_t mode) {
  const auto& shapes = body.report.modes.shapes;
  if (mode >= shapes.size())
    return std::vector<double>(3 * body.solid.complex.n_corners(), 0.0);
  const auto numbers = dynamics::flat(shapes[mode]);
  return {numbers.begin(), numbers.end()};
}

std::vector<double> values_of(const Body& body, const std::string& name) {
  if (name == "displacement")
    return displacements(body);
  const fem::Hexahedra& model = elements_of(body)->own_model();
  const Points& x = body.state.x;
  const auto tensors = fem::at_corners(
    model, body.physics->rest(), name == "strain" ? fem::strain_of_copies(model, x) : fem::stress_of_copies(model, x));
  std::vector<double> values;
  for (const Mat3& tensor : tensors)
    if (name == "von Mises stress")
      values.push_back(fem::von_mises(tensor));
    else
      append(tensor, values);
  return values;
}

} // namespace

std::string field_names() {
  std::string names;
  for (const Kind& kind : kinds)
    names += (names.empty() ? "" : ", ") + std::string(kind.name);
  return names;
}

bool is_field(const std::string& name) { return find_kind(name) != nullptr; }

bool has_field(const Body& body, const std::string& name) {
  if (name == "modes")
    return body.n_modes > 0 && body.physics->particles_are_corners();
  return name == "displacement" || elements_of(body);
}

std::vector<output::Field> announced(const Body& body, const std::vector<std::string>& names) {
  std::vector<output::Field> fields;
  for (const std::string& name : names) {
    const Kind& kind = *find_kind(name);
    if (name != "modes")
      fields.push_back({kind.dataset, kind.unit, kind.n_components, {}});
    else
      for (int i = 1; i <= body.n_modes; ++i)
        fields.push_back({kind.dataset + std::to_string(i), kind.unit, kind.n_components, {}});
  }
  return fields;
}

std::vector<output::Field> fields_at_corners(const Body& body, const std::vector<std::string>& names) {
  std::vector<output::Field> fields = announced(body, names);
  auto field = fields.begin();
  for (const std::string& name : names)
    if (name != "modes")
      (field++)->values = values_of(body, name);
    else
      for (std::size_t i = 0; i < static_cast<std::size_t>(body.n_modes); ++i)
        (field++)->values = shape_of(body, i);
  return fields;
}

std::vector<output::Field> at_vertices(const surface::Surface& surface, const std::vector<output::Field>& of_corners) {
  const Interpolation& W = surface.weights;
  std::vector<output::Field> fields;
  for (const output::Field& from : of_corners) {
    const std::size_t n = from.n_components;
    output::Field field{from.name, from.unit, n, std::vector<double>(n * W.n_points(), 0.0)};
    for (std::size_t row = 0; row < W.n_points(); ++row)
      for (auto k = W.start[row]; k < W.start[row + 1]; ++k)
        for (std::size_t i = 0; i < n; ++i)
          field.values[n * row + i] += W.values[k] * from.values[n * W.columns[k] + i];
    fields.push_back(std::move(field));
  }
  return fields;
}

} // namespace kerf::scene
