// What a damaged mesh file is refused with: a line, or how its length and its header disagree.

#include "geometry/mesh_fault.h"

#include "base/error.h"
#include "geometry/triangle_mesh.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace kerf::geometry::mesh_fault_test {
namespace {

const std::string off = "OFF # a comment\n4 4 0\n\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const std::string ply =
  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
  "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

std::string error_of(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / ("kerf_fault_" + std::to_string(getpid()) + "_" + name);
  std::ofstream(path, std::ios::binary) << text;
  std::string error;
  try {
    read_mesh(path.string(), 1);
  } catch (const DataError& refused) {
    error = refused.what();
  }
  std::filesystem::remove(path);
  return error;
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

void expect(const std::string& error, const std::string& part) {
  EXPECT_NE(error.find(part), std::string::npos) << "no '" << part << "' in: " << error;
}

TEST(MeshFault, WholeMeshesHaveNone) {
  EXPECT_EQ(error_of("whole.off", off), "");
  EXPECT_EQ(error_of("whole.ply", ply), "");
  EXPECT_EQ(error_of("no_last_end.off", off.substr(0, off.size() - 1)), "");
}

TEST(MeshFault, NamesTheLine) {
  expect(error_of("nan.off", with(off, "1 0 0", "nan 0 0")), "line 5: 'nan' is no finite number");
  expect(error_of("huge.off", with(off, "1 0 0", "1e999 0 0")), "line 5: '1e999' is no finite number");
  expect(error_of("short.off", with(off, "0 1 0", "0 1")), "line 6: 2 numbers stand where there must be 3");
  expect(error_of("index.off", with(off, "3 0 1 3", "3 0 1 9")), "line 9: there is no vertex 9");
  expect(error_of("nan.ply", with(ply, "1 0 0", "1 inf 0")), "line 11: 'inf' is no finite number");
  expect(error_of("nan.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n"), "line 3: 'nan' is no finite number");
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n", faces = "f 1 3 2\nf 1//1 2/1 -1\nf 2 3 4\n";
  EXPECT_EQ(error_of("whole.obj", points + faces + "f 1 4 3\n"), "");
  expect(error_of("zero.obj", points + faces + "f 1 0 3\n"), "line 8: there is no vertex 0");
  expect(error_of("beyond.obj", points + faces + "f 1 5 3\n"), "line 8: there is no vertex 5");
  expect(error_of("far.obj", points + faces + "f 1 999999999999 3\n"), "line 8: there is no vertex 999999999999");
  expect(error_of("two.obj", points + faces + "f 1 4\n"), "line 8: a face must have 3 corners and more");
  expect(error_of("marked.off", "\xEF\xBB\xBF" + off), "line 1: it begins with a byte order mark");
  expect(error_of("marked.obj", "\xEF\xBB\xBF" + points + faces + "f 1 4 3\n"), "line 1: it begins with a byte order");
}

/// The library that reads them writes past the end of a list there.
TEST(MeshFault, APropertyBeforeAnyElementIsRefused) {
  expect(error_of("stray.ply", with(ply, "element vertex 3\n", "")), "a property stands before any element");
}

TEST(MeshFault, SaysWhereAFileEnds) {
  expect(error_of("cut.off", off.substr(0, off.find("3 0 3 2"))),
         "it ends in line 9, after 4 of 4 vertices and 2 of 4 faces");
  expect(error_of("cut.ply", ply.substr(0, ply.find("0 1 0"))), "it ends in line 11, after 2 of 3 vertices and 0 of 1");
}

/// Before anyone makes room for it.
TEST(MeshFault, AHeaderMustFitIntoTheFile) {
  expect(error_of("promise.off", with(off, "4 4 0", "4 1000000000 0")),
         "the header promises 4 vertices and 1000000000 faces, which do not fit into the file's");
  expect(error_of("promise.ply", with(ply, "vertex 3", "vertex 4000000000")), "promises 4000000000 vertices");
  std::string stl(84, '\0');
  stl[83] = '\x7f';
  expect(error_of("promise.stl", stl), "which do not fit into the file's 84 bytes");
}

} // namespace
} // namespace kerf::geometry::mesh_fault_test
