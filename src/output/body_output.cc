#include "output/body_output.h"

#include "base/error.h"
#include "output/names.h"

#include <type_traits>

namespace kerf::output {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double) && std::is_same_v<Index3::value_type, std::int32_t>);

/// What a dataset says about itself.
struct Label {
  std::string unit, text;
};

void describe(const h5::Object& dataset, const Label& label) {
  h5::set_attribute(dataset, "unit", label.unit);
  h5::set_attribute(dataset, "text", label.text);
}

const Label position_label = {"m", "position per corner"};
const Label velocity_label = {"m/s", "velocity per corner"};

void write_points(const h5::Object& group, const std::string& name, const std::span<const Vec3> points,
                  const Label& label, const std::string& configuration,
                  const h5::Storage storage = h5::Storage::compressed) {
  const auto dataset = h5::write_items<double>(group, name, points, storage);
  describe(dataset, label);
  h5::set_attribute(dataset, "configuration", configuration);
}

template <class T, class Row>
void write_table(const h5::Object& group, const std::string& name, const std::vector<Row>& rows, const Label& label) {
  describe(h5::write_items<T>(group, name, std::span(rows)), label);
}

void write_complex(const h5::Object& group, const Complex& complex) {
  write_table<std::uint32_t>(group, "corners", complex.corners, {"1", "corners of each copy, deal.II's vertex order"});
  write_table<std::int32_t>(group, "cell", complex.cells, {"1", "lattice index of each copy's cell"});
  write_table<std::uint8_t>(group, "nodes", complex.nodes, {"1", "bits of the material nodes of each copy"});
  write_table<std::uint32_t>(
    group, "skin", complex.skin,
    {"1", "bits of the points of the skin that each copy holds, where blades have cut the skin of its cell"});
  write_points(group, "rest_position", complex.rest_positions, position_label, "rest");
}

void write_surface(const h5::Object& group, const Surface& surface) {
  write_table<std::uint32_t>(group, "triangles", surface.triangles,
                             {"1", "vertices, counter-clockwise seen from outside"});
  write_table<std::uint16_t>(group, "label", surface.labels, {"1", "which cut revealed the triangle; 0 is the skin"});
  write_points(group, "rest_position", surface.rest_positions, {"m", "position per vertex"}, "rest");
  const auto weights = h5::create_group(group, "weights");
  h5::set_attribute(weights, "text",
                    std::string("sparse rows of W; surface vertices are W times corners, in any frame"));
  const auto& start = surface.weights.start;
  write_table<std::uint64_t>(weights, "row_start", std::vector<std::uint64_t>(start.begin(), start.end()),
                             {"1", "first entry of each vertex"});
  write_table<std::uint32_t>(weights, "column", surface.weights.columns, {"1", "corner of each entry"});
  write_table<double>(weights, "value", surface.weights.values, {"1", "weight of each entry"});
}

template <class Row>
void append_samples(const h5::Object& root, const std::string& path, const h5::Layout& layout,
                    const std::vector<Row>& rows, const Label& label) {
  if (!h5::exists(root, path))
    describe(h5::create_series(root, path, layout, 4096), label);
  h5::append_rows(h5::open_dataset(root, path), layout, rows.data(), rows.size());
}

/// The samples go behind those of earlier surfaces.
void write_colours(const h5::Object& root, const h5::Object& surface, const std::string& body, const Colours& colours) {
  write_table<std::uint32_t>(surface, "first_sample", colours.first,
                             {"1", "row of the body's colours where each triangle's begin; 2^32 - 1 without"});
  write_table<std::uint16_t>(surface, "parts", colours.parts,
                             {"1",
                              "n: the triangle a, b, c has samples at a + i/n (b - a) + j/n (c - a), i slower "
                              "than j; 0 without"});
  append_samples(root, body_path(body, "colours"), {h5::Number::uint8, 3}, colours.samples,
                 {"1", "sRGB samples of revealed triangles"});
  if (!colours.slopes.empty())
    append_samples(root, body_path(body, "slopes"), {h5::Number::float32, 2}, colours.slopes,
                   {"m", "rise of the relief along (b - a) and (c - a) of each sample's triangle"});
}

void write_frame(const h5::Object& frame, const BodyStep& step) {
  write_points(frame, "position", step.positions, position_label, "current", h5::Storage::plain);
  if (!step.velocities.empty())
    write_points(frame, "velocity", step.velocities, velocity_label, "current", h5::Storage::plain);
  for (const auto& field : step.fields) {
    const h5::Layout layout = {h5::Number::float64, field.n_components};
    const auto rows = field.values.size() / field.n_components;
    const auto dataset =
      h5::write_rows(frame, "fields/" + field.name, layout, field.values.data(), rows, h5::Storage::plain);
    describe(dataset, {field.unit, field.n_components == 6 ? "per corner: xx, yy, zz, xy, yz, xz" : "per corner"});
  }
}

class Checks {
 public:
  Checks(const std::string& file, const std::string& body) : file_(file), body_(body) {}

  void equal(const std::string& what, const std::size_t n, const std::size_t wanted) const {
    if (n != wanted)
      fail(what, std::to_string(n), "must have " + std::to_string(wanted) + " entries");
  }

  [[noreturn]] void fail(const std::string& what, const std::string& value, const std::string& rule) const {
    throw DataError({.file = file_,
                     .path = body_path(body_, what),
                     .value = value,
                     .rule = rule,
                     .remedy = "Nothing was written; hand over arrays that fit each other"});
  }

 private:
  std::string file_, body_;
};

void check_surface(const Surface& surface, const Checks& checks) {
  const auto& w = surface.weights;
  checks.equal("surface/label", surface.labels.size(), surface.triangles.size());
  checks.equal("surface/weights/row_start", w.start.size(), surface.rest_positions.size() + 1);
  checks.equal("surface/weights/column", w.columns.size(), w.start.back());
  checks.equal("surface/weights/value", w.values.size(), w.start.back());
}

} // namespace

void check(const BodyStep& step, const BodyCounts& counts, const std::string& file) {
  const Checks checks(file, step.body);
  if (step.complex == nullptr && counts.n_complexes == 0)
    checks.fail("complex", "", "must be written with the first frame");
  if (step.complex != nullptr) {
    checks.equal("complex/cell", step.complex->cells.size(), step.complex->corners.size());
    checks.equal("complex/nodes", step.complex->nodes.size(), step.complex->corners.size());
    checks.equal("complex/skin", step.complex->skin.size(), step.complex->corners.size());
  }
  const auto n_corners = step.complex != nullptr ? step.complex->rest_positions.size() : counts.n_corners;
  checks.equal("frames/position", step.positions.size(), n_corners);
  if (!step.velocities.empty())
    checks.equal("frames/velocity", step.velocities.size(), n_corners);
  for (const auto& field : step.fields)
    checks.equal("frames/fields/" + field.name, field.values.size(), n_corners * field.n_components);
  if (step.surface != nullptr)
    check_surface(*step.surface, checks);
  if (step.surface != nullptr && step.colours != nullptr) {
    checks.equal("surface/first_sample", step.colours->first.size(), step.surface->triangles.size());
    checks.equal("surface/parts", step.colours->parts.size(), step.surface->triangles.size());
    if (!step.colours->slopes.empty())
      checks.equal("slopes", step.colours->slopes.size(), step.colours->samples.size());
  }
}

void write_body(const h5::Object& root, const BodyStep& step, const double time, const std::int64_t number,
                BodyCounts& counts) {
  const auto path = [&](const char* part, const std::size_t i) { return body_path(step.body, part) + index_name(i); };
  if (step.complex != nullptr) {
    write_complex(h5::create_group(root, path("complex/", counts.n_complexes++)), *step.complex);
    counts.n_corners = step.complex->rest_positions.size();
  }
  if (step.surface != nullptr) {
    const auto group = h5::create_group(root, path("surface/", counts.n_surfaces++));
    write_surface(group, *step.surface);
    if (step.colours != nullptr)
      write_colours(root, group, step.body, *step.colours);
  }

  const auto frame = h5::create_group(root, path("frames/", counts.n_frames++));
  h5::set_attribute(frame, "time", time);
  h5::set_attribute(frame, "step", number);
  h5::set_attribute(frame, "complex_index", static_cast<std::int64_t>(counts.n_complexes - 1));
  h5::link(frame, "complex", path("complex/", counts.n_complexes - 1));
  if (counts.n_surfaces > 0)
    h5::link(frame, "surface", path("surface/", counts.n_surfaces - 1));
  if (!step.fields.empty())
    h5::create_group(frame, "fields");
  write_frame(frame, step);
}

} // namespace kerf::output
