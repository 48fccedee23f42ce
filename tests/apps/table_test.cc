#include "surface/table.h"
#include "grid/cube.h"
#include "tests/apps/program.h"
#include "tests/output/array.h"

#include <set>

namespace kerf::apps::table_test {
namespace {

namespace cube = grid::cube;

using output::Array;
using output::read_array;
using output::Shape;

/// What `kerf table` writes, against the table itself.
class TableOfTheProgram : public Program {
 protected:
  void SetUp() override { ASSERT_EQ(kerf({"table", "--output", path_.string()}).exit_code, 0); }

  std::filesystem::path path_ = folder / "table.h5";
  const surface::SplittingTable& table_ = surface::splitting_table();
};

TEST_F(TableOfTheProgram, HoldsTheComponents) {
  const Array cell = read_array(path_, "/cell_component"), face = read_array(path_, "/face_component");
  ASSERT_EQ(cell.shape, (Shape{4096, 8}));
  ASSERT_EQ(face.shape, (Shape{4096, 6, 4}));
  for (unsigned row = 0; row < 4096; ++row) {
    for (unsigned v = 0; v < 8; ++v)
      ASSERT_EQ(cell({row, v}), table_.cell_component(row, static_cast<int>(v)));
    for (unsigned f = 0; f < 6; ++f)
      for (unsigned i = 0; i < 4; ++i)
        ASSERT_EQ(face({row, f, i}), surface::face_component(row, static_cast<int>(f), cube::face_vertices[f][i]));
  }
}

TEST_F(TableOfTheProgram, HoldsTheQuads) {
  const Array quads = read_array(path_, "/quads"), row_start = read_array(path_, "/row_start");
  ASSERT_EQ(row_start.shape, (Shape{4097}));
  ASSERT_EQ(quads.shape, (Shape{table_.quads().size(), 4, 3}));
  for (unsigned row = 0; row <= 4096; ++row)
    ASSERT_EQ(row_start({row}), static_cast<int>(table_.row_start()[row]));
  for (std::size_t q = 0; q < table_.quads().size(); ++q)
    for (std::size_t i = 0; i < 4; ++i) {
      const auto& vertex = table_.quads()[q].vertices[i];
      ASSERT_EQ(quads({q, i, 0}), static_cast<int>(vertex.kind));
      ASSERT_EQ(quads({q, i, 1}), vertex.index);
      ASSERT_EQ(quads({q, i, 2}), vertex.side);
    }
}

/// With nothing but the file: what its attributes promise about quads, cut lines and face vertices.
TEST_F(TableOfTheProgram, IsEnoughByItself) {
  const Array quads = read_array(path_, "/quads"), row_start = read_array(path_, "/row_start"),
              lines = read_array(path_, "/line_vertices"), faces = read_array(path_, "/face_vertices"),
              cell = read_array(path_, "/cell_component"), face = read_array(path_, "/face_component");
  for (std::size_t row = 0; row < 4096; ++row) {
    std::set<std::pair<int, int>> expected, found;
    for (std::size_t line = 0; line < 12; ++line)
      for (std::size_t end = 0; end < 2; ++end)
        if (row >> line & 1)
          expected.emplace(line, lines({line, end}));
    for (std::size_t q = row_start({row}); q < static_cast<std::size_t>(row_start({row + 1})); ++q) {
      const std::size_t end = quads({q, 0, 2});
      found.emplace(quads({q, 0, 1}), end);
      ASSERT_EQ(quads({q, 2, 2}), cell({row, end}));
      for (const std::size_t corner : {1u, 3u}) {
        const std::size_t f = quads({q, corner, 1});
        for (std::size_t i = 0; i < 4; ++i)
          if (faces({f, i}) == static_cast<int>(end)) {
            ASSERT_EQ(quads({q, corner, 2}), face({row, f, i}));
          }
      }
    }
    ASSERT_EQ(found, expected) << row;
  }
}

TEST_F(TableOfTheProgram, RefusesWhatIsNoFile) {
  expect_error(kerf({"table"}), 1, {"--output", "must be given"});
  expect_error(kerf({"table", "--output"}), 1, {"--output", "needs one value"});
  expect_error(kerf({"table", "--bogus"}), 1, {"'--bogus'", "is no option"});
  expect_error(kerf({"table", "--output", "nowhere/table.h5"}), 2, {"nowhere/table.h5", "cannot be written"});
}

} // namespace
} // namespace kerf::apps::table_test
