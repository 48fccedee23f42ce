// Fields at the vertices of a surface file: found again by their offsets; what does not fit is refused.

#include "base/error.h"
#include "output/array_file.h"
#include "tests/output/surface_steps.h"

#include <gtest/gtest.h>

namespace kerf::output::surface_fields_test {
namespace {

const std::vector<Field> announced = {{"stress", "Pa", 6, {}}, {"heat", "K", 1, {}}};

/// Values that tell step, vertex and component.
std::vector<Field> fields_at(const std::size_t step, const std::size_t n_vertices) {
  std::vector<Field> fields = announced;
  for (std::size_t k = 0; k < 6 * n_vertices; ++k)
    fields[0].values.push_back(1000. * double(step) + double(k) / 64);
  for (std::size_t k = 0; k < n_vertices; ++k)
    fields[1].values.push_back(-double(k + step));
  return fields;
}

SurfaceStep step_of(const SampleSurface& surface, const std::size_t i, const std::span<const Field> fields) {
  return {0.5 * double(i),
          surface.positions,
          surface.rest_positions,
          surface.triangles,
          surface.labels,
          i % 3 == 0 ? Topology::changed : Topology::unchanged,
          fields};
}

TEST(SurfaceFields, EveryStepHasItsOwn) {
  const TemporaryFolder folder;
  {
    SurfaceFile file(folder / "surface.vtkhdf", announced);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto surface = surface_at(i);
      file.append(step_of(surface, i, fields_at(i, surface.positions.size())));
    }
  }
  const auto root = h5::open_read_only(folder / "surface.vtkhdf");
  for (const Field& field : announced) {
    const auto offsets = h5::read_vector<std::int64_t>(root, "/VTKHDF/Steps/PointDataOffsets/" + field.name);
    const auto values = h5::read_vector<float>(root, "/VTKHDF/PointData/" + field.name);
    ASSERT_EQ(offsets.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto all = fields_at(i, surface_at(i).positions.size());
      const auto& expected = all[field.name == "stress" ? 0 : 1].values;
      for (std::size_t k = 0; k < expected.size(); ++k)
        ASSERT_EQ(values.at(field.n_components * static_cast<std::size_t>(offsets[i]) + k),
                  static_cast<float>(expected[k]));
    }
  }
  const SurfaceReader reader(folder / "surface.vtkhdf");
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_TRUE(reader.holds(surface_at(i), i)) << "what else there is stays where it was";
}

TEST(SurfaceFields, ThatDoNotFitAreRefused) {
  const TemporaryFolder folder;
  SurfaceFile file(folder / "surface.vtkhdf", announced);
  const auto surface = surface_at(0);
  const std::size_t n = surface.positions.size();
  auto fields = fields_at(0, n);
  EXPECT_THROW(file.append(step_of(surface, 0, {})), DataError);
  EXPECT_THROW(file.append(step_of(surface, 0, fields_at(0, n - 1))), DataError);
  std::swap(fields[0], fields[1]);
  EXPECT_THROW(file.append(step_of(surface, 0, fields)), DataError);
  std::swap(fields[0], fields[1]);
  EXPECT_NO_THROW(file.append(step_of(surface, 0, fields)));
}

TEST(ArrayFile, HoldsWhatItWasGiven) {
  const TemporaryFolder folder;
  const std::vector<NamedArray> arrays = {{"a/b/table", "m", "a table", {2, 3}, {1, 2, 3, 4, 5, 6}},
                                          {"a/number", "1", "a number", {1}, {0.5}}};
  write_array_file(folder / "arrays.h5", "title", "source", arrays, sample_info());
  const auto root = h5::open_read_only(folder / "arrays.h5");
  EXPECT_EQ(h5::text_attribute(root, "title"), "title");
  EXPECT_EQ(h5::read_vector<double>(root, "/a/b/table"), arrays[0].values);
  EXPECT_EQ(h5::n_columns(h5::open_dataset(root, "/a/b/table")), 3u);
  EXPECT_EQ(h5::text_attribute(h5::open_dataset(root, "/a/number"), "unit"), "1");
  const std::vector<NamedArray> wrong = {{"x", "1", "", {2}, {1}}};
  EXPECT_THROW(write_array_file(folder / "wrong.h5", "", "", wrong, sample_info()), DataError);
  EXPECT_FALSE(std::filesystem::exists(folder / "wrong.h5"));
}

} // namespace
} // namespace kerf::output::surface_fields_test
