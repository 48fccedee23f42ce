#include "output/table_file.h"

#include "base/error.h"
#include "grid/cube.h"
#include "output/h5_array.h"
#include "tests/output/array.h"
#include "tests/output/samples.h"

#include <gtest/gtest.h>

namespace kerf::output::table_file_test {
namespace {

namespace cube = grid::cube;

/// Two rows that nobody would take for a real table: each number tells its place.
SplittingTable small_table() {
  SplittingTable table;
  for (std::uint8_t row = 0; row < 2; ++row) {
    auto& cell = table.cell_component.emplace_back();
    std::iota(cell.begin(), cell.end(), static_cast<std::uint8_t>(10 * row));
    auto& faces = table.face_component.emplace_back();
    for (std::uint8_t face = 0; face < 6; ++face)
      for (std::uint8_t i = 0; i < 4; ++i)
        faces[face][i] = static_cast<std::uint8_t>(100 * row + 10 * face + i);
  }
  table.row_start = {0, 1, 3};
  for (std::uint8_t quad = 0; quad < 3; ++quad) {
    auto& corners = table.quads.emplace_back();
    for (std::uint8_t i = 0; i < 4; ++i)
      corners[i] = {static_cast<std::uint8_t>(50 * quad + 10 * i), static_cast<std::uint8_t>(50 * quad + 10 * i + 1),
                    static_cast<std::uint8_t>(50 * quad + 10 * i + 2)};
  }
  table.line_vertices = cube::line_vertices;
  table.face_vertices = cube::face_vertices;
  table.face_lines = cube::face_lines;
  return table;
}

TEST(TableFile, EveryNumberStandsInItsPlace) {
  const TemporaryFolder folder;
  const auto path = folder / "table.h5";
  write_table_file(path, small_table(), "1.2.3");
  const Array cell = read_array(path, "/cell_component"), face = read_array(path, "/face_component"),
              quads = read_array(path, "/quads");
  EXPECT_EQ(cell.shape, (Shape{2, 8}));
  EXPECT_EQ(cell({1, 3}), 13);
  EXPECT_EQ(face.shape, (Shape{2, 6, 4}));
  EXPECT_EQ(face({1, 5, 2}), 152);
  EXPECT_EQ(read_array(path, "/row_start").values, (std::vector<int>{0, 1, 3}));
  EXPECT_EQ(quads.shape, (Shape{3, 4, 3}));
  EXPECT_EQ(quads({2, 1, 2}), 112);
  const Array lines = read_array(path, "/line_vertices"), faces = read_array(path, "/face_vertices"),
              face_lines = read_array(path, "/face_lines");
  EXPECT_EQ(lines.shape, (Shape{12, 2}));
  EXPECT_EQ(faces.shape, (Shape{6, 4}));
  EXPECT_EQ(face_lines.shape, (Shape{6, 4}));
  for (std::size_t line = 0; line < 12; ++line)
    EXPECT_EQ(lines({line, 1}), cube::line_vertices[line][1]);
  for (std::size_t f = 0; f < 6; ++f)
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(faces({f, i}), cube::face_vertices[f][i]);
      EXPECT_EQ(face_lines({f, i}), cube::face_lines[f][i]);
    }
}

TEST(TableFile, SaysWhatItIs) {
  const TemporaryFolder folder;
  write_table_file(folder / "table.h5", small_table(), "1.2.3");
  const auto root = h5::open_read_only(folder / "table.h5");
  EXPECT_EQ(h5::text_attribute(root, "version"), "1.2.3");
  EXPECT_NE(h5::text_attribute(root, "source").find("Pietroni"), std::string::npos);
  EXPECT_NE(h5::text_attribute(root, "numbering").find("deal.II"), std::string::npos);
  EXPECT_FALSE(h5::text_attribute(root, "surface").empty());
  const auto names = h5::children(root, "/");
  EXPECT_EQ(names.size(), 7u);
  for (const auto& name : names) {
    const auto dataset = h5::open_dataset(root, name);
    EXPECT_FALSE(h5::text_attribute(dataset, "description").empty()) << name;
    EXPECT_FALSE(h5::text_attribute(dataset, "columns").empty()) << name;
  }
}

TEST(TableFile, RefusesWhatDoesNotFit) {
  const TemporaryFolder folder;
  auto table = small_table();
  table.quads.pop_back();
  EXPECT_THROW(write_table_file(folder / "table.h5", table, "1"), DataError);
  EXPECT_FALSE(std::filesystem::exists(folder / "table.h5"));
  table = small_table();
  table.row_start.clear();
  EXPECT_THROW(write_table_file(folder / "table.h5", table, "1"), DataError);
  EXPECT_THROW(write_table_file(folder / "nowhere" / "table.h5", small_table(), "1"), DataError);
}

} // namespace
} // namespace kerf::output::table_file_test
