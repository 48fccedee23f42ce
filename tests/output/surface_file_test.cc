#include "output/surface_file.h"

#include "base/error.h"
#include "tests/output/surface_steps.h"

#include <gtest/gtest.h>

namespace kerf::output::surface_file_test {
namespace {

TEST(SurfaceFile, EveryStepReadsBackByTheSpecification) {
  const TemporaryFolder folder;
  {
    SurfaceFile file(folder / "surface.vtkhdf");
    for (std::size_t i = 0; i < 8; ++i)
      append_surface(file, i);
  }
  const SurfaceReader reader(folder / "surface.vtkhdf");
  ASSERT_EQ(reader.n_steps(), 8u);
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_TRUE(reader.holds(surface_at(i), i)) << "step " << i;
  EXPECT_FALSE(reader.holds(surface_at(3), 4));
}

TEST(SurfaceFile, SaysWhatItIs) {
  const TemporaryFolder folder;
  SurfaceFile(folder / "surface.vtkhdf");
  const auto root = h5::open_read_only(folder / "surface.vtkhdf");
  const auto vtk = h5::open_group(root, "/VTKHDF");
  EXPECT_EQ(h5::text_attribute(vtk, "Type"), "PolyData");
  EXPECT_EQ(h5::integer_attribute(h5::open_group(vtk, "Steps"), "NSteps"), 0);
}

TEST(SurfaceFile, ConnectivityIsWrittenOnlyWhereItChanges) {
  const TemporaryFolder folder;
  {
    SurfaceFile file(folder / "surface.vtkhdf");
    for (std::size_t i = 0; i < 6; ++i) // two topologies
      append_surface(file, i);
  }
  const auto root = h5::open_read_only(folder / "surface.vtkhdf");
  const auto n_triangles = surface_at(0).triangles.size() + surface_at(3).triangles.size();
  EXPECT_EQ(h5::n_rows(h5::open_dataset(root, "/VTKHDF/Polygons/Connectivity")), 3 * n_triangles);
  EXPECT_EQ(h5::n_rows(h5::open_dataset(root, "/VTKHDF/CellData/label")), n_triangles);
}

TEST(SurfaceFile, RefusesArraysThatDoNotFitAndTakesTheNext) {
  const TemporaryFolder folder;
  {
    SurfaceFile file(folder / "surface.vtkhdf");
    const auto first = surface_at(0), other = surface_at(3);
    EXPECT_THROW(file.append({0, first.positions, {}, {}, {}, Topology::unchanged}), DataError);
    EXPECT_THROW(file.append({0, first.positions, other.rest_positions, first.triangles, first.labels}), DataError);
    EXPECT_THROW(file.append({0, first.positions, first.rest_positions, first.triangles, other.labels}), DataError);
    const std::vector<Triangle> outside = {{0, 1, static_cast<std::uint32_t>(first.positions.size())}};
    const std::vector<std::uint16_t> label = {0};
    EXPECT_THROW(file.append({0, first.positions, first.rest_positions, outside, label}), DataError);
    EXPECT_THROW(file.append({0, {}, {}, {}, {}, Topology::unchanged}), DataError);
    append_surface(file, 0);
  }
  const SurfaceReader reader(folder / "surface.vtkhdf");
  ASSERT_EQ(reader.n_steps(), 1u);
  EXPECT_TRUE(reader.holds(surface_at(0), 0));
}

} // namespace
} // namespace kerf::output::surface_file_test
