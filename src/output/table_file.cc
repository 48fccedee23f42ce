#include "output/table_file.h"

#include "base/error.h"
#include "output/h5_array.h"

namespace kerf::output {
namespace {

constexpr const char* numbering =
  "deal.II's (GeometryInfo<3>). Vertex v stands at (v & 1, v >> 1 & 1, v >> 2 & 1) of the unit cube. Lines: "
  "/line_vertices; faces: /face_vertices and /face_lines. Bit i of a row's index, 0 .. 4095, says whether line i is "
  "cut.";

constexpr const char* surface =
  "For each cut line and each of its two ends s one quad: edge vertex, face vertex, centre, face vertex; "
  "counter-clockwise "
  "seen from outside of the material of s. Split it along edge vertex - centre, as its partner on the other side. Ends "
  "that are empty have no quads: leave those quads out.";

constexpr const char* component =
  "Components are named by their smallest vertex, numbered as a vertex of the cell, 0 .. 7.";

struct Text {
  std::string description, columns;
};

void describe(const h5::Object& dataset, const Text& text) {
  h5::set_attribute(dataset, "description", text.description);
  h5::set_attribute(dataset, "columns", text.columns);
}

template <class T, class Items>
void write(const h5::Object& root, const std::string& name, const Items& items, const std::vector<std::size_t>& shape,
           const Text& text) {
  describe(h5::write_array(root, name, {h5::number_of<T>, shape}, items.data()), text);
}

void write_rows_of_table(const h5::Object& root, const SplittingTable& table) {
  const std::size_t n_rows = table.cell_component.size(), n_quads = table.quads.size();
  write<std::uint8_t>(
    root, "cell_component", table.cell_component, {n_rows, 8},
    {"For each row and each vertex of the cell, the component it belongs to: vertices joined by lines of "
     "the cell that are not cut. " +
       std::string(component),
     "vertex of the cell"});
  write<std::uint8_t>(
    root, "face_component", table.face_component, {n_rows, 6, 4},
    {"For each row, face and vertex of the face, in the order of /face_vertices, the component within "
     "the face: vertices joined by the face's own four lines that are not cut. " +
       std::string(component),
     "face; vertex of the face"});
  write<std::uint32_t>(root, "row_start", table.row_start, {n_rows + 1},
                       {"Row c has the quads row_start[c] .. row_start[c + 1] - 1.", "none"});
  write<std::uint8_t>(
    root, "quads", table.quads, {n_quads, 4, 3},
    {"The corners of each quad. Corners of quads of a row that have the same kind, index and side are one "
     "vertex. Kind: 0 edge vertex, 1 face vertex, 2 centre. Index: the line, the face, or 0. Side: of "
     "an edge vertex the end of the line, whose material the quad bounds; else the component. " +
       std::string(component),
     "corner: edge vertex, face vertex, centre, face vertex; kind, index, side"});
}

void write_numbering(const h5::Object& root, const SplittingTable& table) {
  write<std::int32_t>(root, "line_vertices", table.line_vertices, {12, 2},
                      {"The two vertices of each line, lower one first.", "end"});
  write<std::int32_t>(root, "face_vertices", table.face_vertices, {6, 4}, {"The vertices of each face.", "vertex"});
  write<std::int32_t>(root, "face_lines", table.face_lines, {6, 4}, {"The lines of each face.", "line"});
}

void check_sizes(const std::string& file, const SplittingTable& table) {
  const auto check = [&](const std::string& what, const std::size_t n, const std::size_t wanted) {
    if (n != wanted)
      throw DataError({.file = file,
                       .path = what,
                       .value = std::to_string(n),
                       .rule = "must have " + std::to_string(wanted) + " entries",
                       .remedy = "Nothing was written; hand over arrays that fit each other"});
  };
  check("face_component", table.face_component.size(), table.cell_component.size());
  check("row_start", table.row_start.size(), table.cell_component.size() + 1);
  check("quads", table.quads.size(), table.row_start.back());
}

} // namespace

void write_table_file(const std::filesystem::path& path, const SplittingTable& table, const std::string& version) {
  check_sizes(path.string(), table);
  h5::WritableFile file(path, JournaledFile::Mode::create);
  file.transaction([&] {
    const h5::Object& root = file.root();
    h5::set_attribute(root, "title", std::string("Splitting Cubes table: the surface inside a cell, by its cut lines"));
    h5::set_attribute(root, "version", version);
    h5::set_attribute(root, "source",
                      std::string("N. Pietroni, A robust approach to interactive virtual cutting: geometry and color, "
                                  "2009, sections 2.4.2 and 2.5; whether vertices of a face are one is decided by the "
                                  "face's own four lines"));
    h5::set_attribute(root, "numbering", std::string(numbering));
    h5::set_attribute(root, "surface", std::string(surface));
    write_rows_of_table(root, table);
    write_numbering(root, table);
  });
}

} // namespace kerf::output
