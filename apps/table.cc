#include "commands.h"

#include "base/error.h"
#include "grid/cube.h"
#include "output/table_file.h"
#include "scene/build_info.h"
#include "surface/table.h"

#include <cstdio>

namespace kerf::apps {

namespace {

namespace cube = grid::cube;

std::string parse_output(const Arguments& arguments) {
  if (arguments.empty())
    throw ParameterError(
      Complaint{.path = "--output", .rule = "must be given", .remedy = "kerf table --output FILE.h5"});
  if (arguments[0] != "--output")
    throw ParameterError(
      Complaint{.value = arguments[0], .rule = "is no option", .remedy = "The only option is --output FILE.h5"});
  if (arguments.size() != 2 || arguments[1].empty())
    throw ParameterError(
      Complaint{.path = "--output", .rule = "needs one value after it", .remedy = "kerf table --output FILE.h5"});
  return arguments[1];
}

output::SplittingTable to_record(const surface::SplittingTable& table) {
  output::SplittingTable record;
  for (unsigned row = 0; row < surface::SplittingTable::n_rows; ++row) {
    auto& by_vertex = record.cell_component.emplace_back();
    for (int v = 0; v < cube::n_vertices; ++v)
      by_vertex[v] = table.cell_component(row, v);
    auto& by_face = record.face_component.emplace_back();
    for (int face = 0; face < cube::n_faces; ++face)
      for (int i = 0; i < 4; ++i)
        by_face[face][i] = static_cast<std::uint8_t>(surface::face_component(row, face, cube::face_vertices[face][i]));
  }
  record.row_start.assign(table.row_start().begin(), table.row_start().end());
  for (const surface::Quad& quad : table.quads()) {
    auto& corners = record.quads.emplace_back();
    for (int i = 0; i < 4; ++i)
      corners[i] = {static_cast<std::uint8_t>(quad.vertices[i].kind), quad.vertices[i].index, quad.vertices[i].side};
  }
  record.line_vertices = cube::line_vertices;
  record.face_vertices = cube::face_vertices;
  record.face_lines = cube::face_lines;
  return record;
}

} // namespace

int table(const Arguments& arguments) {
  const std::string path = parse_output(arguments);
  const surface::SplittingTable& table = surface::splitting_table();
  output::write_table_file(path, to_record(table), scene::build_info().version);
  std::printf("%s: %u rows, %zu quads\n", path.c_str(), surface::SplittingTable::n_rows, table.quads().size());
  return 0;
}

} // namespace kerf::apps
