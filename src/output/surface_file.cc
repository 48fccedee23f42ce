#include "output/surface_file.h"

#include "base/error.h"
#include "output/h5_array.h"

#include <algorithm>
#include <array>
#include <map>
#include <vector>

namespace kerf::output {
namespace {

constexpr h5::Layout count_layout = {h5::Number::int64, 1};
constexpr h5::Layout point_layout = {h5::Number::float32, 3};

/// The format counts cells in four kinds; ours are all polygons, the third of the columns in Steps.
constexpr const char* cell_kinds[] = {"Vertices", "Lines", "Polygons", "Strips"};
constexpr std::size_t polygons = 2;
constexpr h5::Layout kinds_layout = {h5::Number::int64, 4};

constexpr std::size_t short_chunk = 512, long_chunk = 4096; // rows: one per step; one per vertex or triangle

std::vector<float> single_precision(const std::span<const double> values) { return {values.begin(), values.end()}; }

std::vector<float> single_precision(const std::span<const Vec3> points) {
  std::vector<float> numbers;
  numbers.reserve(3 * points.size());
  for (const auto& p : points)
    for (int i = 0; i < 3; ++i)
      numbers.push_back(static_cast<float>(p[i]));
  return numbers;
}

void check_equal(const std::string& file, const std::string& what, const std::size_t n, const std::size_t wanted) {
  if (n != wanted)
    throw DataError({.file = file,
                     .path = what,
                     .value = std::to_string(n),
                     .rule = "must have " + std::to_string(wanted) + " entries",
                     .remedy = "Nothing was written; hand over arrays that fit each other"});
}

/// A viewer that meets a vertex that is not there may crash.
void check_indices(const std::string& file, const SurfaceStep& step) {
  std::uint32_t largest = 0;
  for (const auto& triangle : step.triangles)
    largest = std::max(largest, *std::ranges::max_element(triangle));
  if (!step.triangles.empty() && largest >= step.positions.size())
    throw DataError({.file = file,
                     .path = "triangles",
                     .value = std::to_string(largest),
                     .rule = "must be below the number of vertices, " + std::to_string(step.positions.size()),
                     .remedy = "Nothing was written; hand over arrays that fit each other"});
}

/// The fields that were announced, in their order, with a row a vertex.
void check_fields(const std::string& file, const SurfaceStep& step, const std::vector<Field>& announced) {
  check_equal(file, "fields", step.fields.size(), announced.size());
  for (std::size_t i = 0; i < announced.size(); ++i) {
    const Field& field = step.fields[i];
    if (field.name != announced[i].name || field.n_components != announced[i].n_components)
      throw DataError(
        {.file = file,
         .path = "fields",
         .value = field.name,
         .rule = "must be " + announced[i].name + ", with " + std::to_string(announced[i].n_components) + " components",
         .remedy = "Nothing was written; bring the fields that the file was made for"});
    check_equal(file, field.name, field.values.size(), field.n_components * step.positions.size());
  }
}

} // namespace

struct SurfaceFile::Contents {
  h5::WritableFile file;
  std::vector<Field> fields = {}; ///< what each step must bring, without values
  h5::Object steps = {};
  std::map<std::string, h5::Object> series = {};
  std::int64_t n_steps = 0;
  std::int64_t n_points = 0; ///< in all steps so far

  /// The topology of the last step; where its parts begin, as the format counts.
  std::int64_t n_topologies = 0, n_topology_points = 0, n_triangles = 0;
  std::int64_t first_rest = 0, first_triangle = 0;

  void create();
  void open();
  /// Calls take(path, layout, rows of a chunk) for each series of the file.
  template <class Function>
  void for_each_series(const Function& take) const;
  std::int64_t last_of(const std::string& path) const;
  void append_count(const std::string& path, const std::int64_t value) {
    h5::append_rows(series.at(path), count_layout, &value, 1);
  }
  void append_kinds(const std::string& path, const std::int64_t n_polygons) {
    std::array<std::int64_t, 4> row = {};
    row[polygons] = n_polygons;
    h5::append_rows(series.at(path), kinds_layout, row.data(), 1);
  }
  void append_topology(const SurfaceStep& step);
  void append_step(const SurfaceStep& step);
};

template <class Function>
void SurfaceFile::Contents::for_each_series(const Function& take) const {
  take("NumberOfPoints", count_layout, short_chunk);
  take("Points", point_layout, long_chunk);
  for (const std::string kind : cell_kinds) {
    const auto chunk = kind == cell_kinds[polygons] ? long_chunk : short_chunk;
    take(kind + "/NumberOfCells", count_layout, short_chunk);
    take(kind + "/NumberOfConnectivityIds", count_layout, short_chunk);
    take(kind + "/Offsets", count_layout, chunk);
    take(kind + "/Connectivity", count_layout, chunk);
  }
  take("PointData/rest_position", point_layout, long_chunk);
  take("CellData/label", h5::Layout{h5::Number::uint16, 1}, long_chunk);
  take("Steps/Values", h5::Layout{h5::Number::float64, 1}, short_chunk);
  for (const auto* name :
       {"PartOffsets", "NumberOfParts", "PointOffsets", "PointDataOffsets/rest_position", "CellDataOffsets/label"})
    take(std::string("Steps/") + name, count_layout, short_chunk);
  for (const Field& field : fields) {
    take("PointData/" + field.name, h5::Layout{h5::Number::float32, field.n_components}, long_chunk);
    take("Steps/PointDataOffsets/" + field.name, count_layout, short_chunk);
  }
  take("Steps/CellOffsets", kinds_layout, short_chunk);
  take("Steps/ConnectivityIdOffsets", kinds_layout, short_chunk);
}

void SurfaceFile::Contents::create() {
  const auto vtk = h5::create_group(file.root(), "/VTKHDF");
  h5::set_attribute(vtk, "Version", std::array<std::int64_t, 2>{2, 0});
  h5::set_attribute(vtk, "Type", std::string("PolyData"));
  for (const auto* kind : cell_kinds)
    h5::create_group(vtk, kind);
  for (const auto* group : {"PointData", "CellData", "Steps/PointDataOffsets", "Steps/CellDataOffsets"})
    h5::create_group(vtk, group);
  steps = h5::open_group(vtk, "Steps");
  h5::set_attribute(steps, "NSteps", n_steps);
  for_each_series([&](const std::string& path, const h5::Layout& layout, const std::size_t chunk) {
    series.emplace(path, h5::create_series(file.root(), "/VTKHDF/" + path, layout, chunk));
  });
  for (const Field& field : fields)
    h5::set_attribute(series.at("PointData/" + field.name), "unit", field.unit);
}

void SurfaceFile::Contents::open() {
  steps = h5::open_group(file.root(), "/VTKHDF/Steps");
  for_each_series([&](const std::string& path, const h5::Layout&, std::size_t) {
    series.emplace(path, h5::open_dataset(file.root(), "/VTKHDF/" + path));
  });
  n_steps = h5::integer_attribute(steps, "NSteps");
  n_points = static_cast<std::int64_t>(h5::n_rows(series.at("Points")));
  n_topologies = static_cast<std::int64_t>(h5::n_rows(series.at("NumberOfPoints")));
  n_topology_points = last_of("NumberOfPoints");
  n_triangles = last_of(std::string(cell_kinds[polygons]) + "/NumberOfCells");
  first_rest = last_of("Steps/PointDataOffsets/rest_position");
  first_triangle = last_of("Steps/CellDataOffsets/label");
}

/// 0 of a series without rows.
std::int64_t SurfaceFile::Contents::last_of(const std::string& path) const {
  std::vector<std::int64_t> values(h5::n_rows(series.at(path)));
  h5::read_rows(series.at(path), count_layout, values.data());
  return values.empty() ? 0 : values.back();
}

void SurfaceFile::Contents::append_topology(const SurfaceStep& step) {
  first_rest += n_topology_points;
  first_triangle += n_triangles;
  n_topology_points = static_cast<std::int64_t>(step.positions.size());
  n_triangles = static_cast<std::int64_t>(step.triangles.size());
  ++n_topologies;

  append_count("NumberOfPoints", n_topology_points);
  for (const std::string kind : cell_kinds) {
    const bool ours = kind == cell_kinds[polygons];
    append_count(kind + "/NumberOfCells", ours ? n_triangles : 0);
    append_count(kind + "/NumberOfConnectivityIds", ours ? 3 * n_triangles : 0);
    if (!ours)
      append_count(kind + "/Offsets", 0);
  }
  std::vector<std::int64_t> offsets, connectivity;
  for (std::int64_t i = 0; i <= n_triangles; ++i)
    offsets.push_back(3 * i);
  for (const auto& triangle : step.triangles)
    connectivity.insert(connectivity.end(), triangle.begin(), triangle.end());
  h5::append_rows(series.at("Polygons/Offsets"), count_layout, offsets.data(), offsets.size());
  h5::append_rows(series.at("Polygons/Connectivity"), count_layout, connectivity.data(), connectivity.size());

  const auto rest = single_precision(step.rest_positions);
  h5::append_rows(series.at("PointData/rest_position"), point_layout, rest.data(), step.rest_positions.size());
  h5::append_rows(series.at("CellData/label"), {h5::Number::uint16, 1}, step.labels.data(), step.labels.size());
}

void SurfaceFile::Contents::append_step(const SurfaceStep& step) {
  if (step.topology == Topology::changed)
    append_topology(step);
  const auto points = single_precision(step.positions);
  h5::append_rows(series.at("Points"), point_layout, points.data(), step.positions.size());

  h5::append_rows(series.at("Steps/Values"), {h5::Number::float64, 1}, &step.time, 1);
  append_count("Steps/NumberOfParts", 1);
  append_count("Steps/PartOffsets", n_topologies - 1); // counts and cells of a topology are one part, used again
  append_count("Steps/PointOffsets", n_points);
  append_count("Steps/PointDataOffsets/rest_position", first_rest);
  for (const Field& field : step.fields) {
    const auto values = single_precision(std::span<const double>(field.values));
    h5::append_rows(series.at("PointData/" + field.name), {h5::Number::float32, field.n_components}, values.data(),
                    step.positions.size());
    append_count("Steps/PointDataOffsets/" + field.name, n_points);
  }
  append_count("Steps/CellDataOffsets/label", first_triangle);
  append_kinds("Steps/CellOffsets", first_triangle);
  append_kinds("Steps/ConnectivityIdOffsets", 3 * first_triangle);
  n_points += static_cast<std::int64_t>(step.positions.size());
  h5::set_attribute(steps, "NSteps", ++n_steps);
}

SurfaceFile::SurfaceFile(const std::filesystem::path& path, const std::span<const Field> fields)
  : contents_(new Contents{.file = {path, JournaledFile::Mode::create}}) {
  for (const Field& field : fields)
    contents_->fields.push_back({field.name, field.unit, field.n_components, {}});
  contents_->file.transaction([&] { contents_->create(); });
}

SurfaceFile::SurfaceFile(std::unique_ptr<Contents> contents) : contents_(std::move(contents)) {}

SurfaceFile SurfaceFile::go_on(const std::filesystem::path& path, const std::span<const Field> fields) {
  auto contents = std::unique_ptr<Contents>(new Contents{.file = {path, JournaledFile::Mode::modify}});
  for (const Field& field : fields)
    contents->fields.push_back({field.name, field.unit, field.n_components, {}});
  contents->open();
  return SurfaceFile(std::move(contents));
}

std::optional<double> SurfaceFile::last_time() const {
  const auto times = h5::read_vector<double>(contents_->file.root(), "/VTKHDF/Steps/Values");
  return times.empty() ? std::nullopt : std::optional(times.back());
}

SurfaceFile::SurfaceFile(SurfaceFile&&) noexcept = default;
SurfaceFile& SurfaceFile::operator=(SurfaceFile&&) noexcept = default;
SurfaceFile::~SurfaceFile() = default;

void SurfaceFile::append(const SurfaceStep& step) {
  const auto& file = contents_->file.root().file;
  if (step.topology == Topology::changed) {
    check_equal(file, "rest_position", step.rest_positions.size(), step.positions.size());
    check_equal(file, "label", step.labels.size(), step.triangles.size());
    check_indices(file, step);
  } else {
    if (contents_->n_topologies == 0)
      throw DataError({.file = file,
                       .path = "topology",
                       .value = "unchanged",
                       .rule = "must be changed in the first step",
                       .remedy = "Nothing was written; hand over the triangles"});
    check_equal(file, "positions (topology unchanged)", step.positions.size(), contents_->n_topology_points);
  }
  check_fields(file, step, contents_->fields);
  contents_->file.transaction([&] { contents_->append_step(step); });
}

} // namespace kerf::output
