#include "base/error.h"
#include "geometry/solid.h"
#include "tests/geometry/meshes.h"
#include "tests/support/checkout.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>

namespace kerf::geometry::triangle_mesh_test {
namespace {

/// A file in the folder for temporary ones, gone at the end.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& name, const std::string& text)
    : path_(std::filesystem::path(testing::TempDir()) /
            (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" + name)) {
    std::ofstream(path_) << text;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

std::string off(const TriangleMesh& mesh) {
  std::string text = "OFF\n";
  text += std::to_string(mesh.vertices.size()) + ' ' + std::to_string(mesh.triangles.size()) + " 0\n";
  for (const Vec3& v : mesh.vertices)
    text += std::to_string(v[0]) + ' ' + std::to_string(v[1]) + ' ' + std::to_string(v[2]) + '\n';
  for (const auto& [a, b, c] : mesh.triangles)
    text += "3 " + std::to_string(a) + ' ' + std::to_string(b) + ' ' + std::to_string(c) + '\n';
  return text;
}

std::string stl(const TriangleMesh& mesh) {
  std::string text = "solid box\n";
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const Vec3& v : corners(mesh, i))
      text += "vertex " + std::to_string(v[0]) + ' ' + std::to_string(v[1]) + ' ' + std::to_string(v[2]) + '\n';
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}

const std::string quads_obj =
  "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
  "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";
const std::string quads_ply =
  "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
  "property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
  "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n"
  "4 0 4 6 2\n4 1 3 7 5\n4 0 1 5 4\n4 2 6 7 3\n4 0 2 3 1\n4 4 5 7 6\n";

TriangleMesh unit_box() { return box_mesh(Vec3::Zero(), Vec3::Ones()); }

/// The message of the DataError that f throws.
template <class Function>
std::string complaint(const Function& f) {
  try {
    f();
  } catch (const DataError& error) {
    EXPECT_EQ(error.exit_code(), 2);
    return error.what();
  }
  return "nothing was thrown";
}

void expect_complaint(const TriangleMesh& mesh, const std::string& part) {
  const std::string message = complaint([&] { require_solid(mesh, "body.off"); });
  EXPECT_NE(message.find(part), std::string::npos) << message;
  EXPECT_EQ(message.find("body.off: "), 0u) << message;
}

void expect_refused(const std::string& name, const std::string& text, const std::string& part) {
  const TemporaryFile file(name, text);
  const std::string message = complaint([&] { read_mesh(file.path(), 1); });
  EXPECT_NE(message.find(part), std::string::npos) << message;
  EXPECT_NE(message.find(file.path()), std::string::npos) << message;
}

TEST(TriangleMesh, VolumeAndBox) {
  const TriangleMesh mesh = box_mesh({1, 2, 3}, {2, 4, 6});
  EXPECT_DOUBLE_EQ(volume(mesh), 6);
  EXPECT_DOUBLE_EQ(volume(inside_out(mesh)), -6);
  EXPECT_EQ(bounding_box(mesh).lower, Vec3(1, 2, 3));
  EXPECT_EQ(bounding_box(mesh).upper, Vec3(2, 4, 6));
  EXPECT_NEAR(volume(sphere_mesh(1, {5, 5, 5}, 5)), 4 * std::numbers::pi / 3, 7e-3);
}

TEST(TriangleMesh, ShellsAreNumberedInOrder) {
  const auto shell = shells(together(unit_box(), box_mesh({2, 0, 0}, {3, 1, 1})));
  EXPECT_EQ(shell.front(), 0u);
  EXPECT_EQ(shell.back(), 1u);
  EXPECT_EQ(std::count(shell.begin(), shell.end(), 1u), 12);
}

TEST(ReadMesh, FourFormatsGiveTheSameSolid) {
  const std::map<std::string, std::string> texts = {
    {"box.off", off(unit_box())}, {"box.obj", quads_obj}, {"BOX.STL", stl(unit_box())}, {"box.ply", quads_ply}};
  for (const auto& [name, text] : texts) {
    const TemporaryFile file(name, text);
    const TriangleMesh mesh = require_solid(read_mesh(file.path(), 0.001), file.path());
    EXPECT_EQ(mesh.vertices.size(), 8u) << name;
    EXPECT_EQ(mesh.triangles.size(), 12u) << name;
    EXPECT_NEAR(volume(mesh), 1e-9, 1e-20) << name;
  }
}

TEST(ReadMesh, FansFillPolygonsThatAreNotConvex) {
  const TemporaryFile file("dart.off", "OFF\n4 1 0\n0 0 0\n2 -1 0\n1 0 0\n2 1 0\n4 0 1 2 3\n");
  const TriangleMesh mesh = read_mesh(file.path(), 1);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_TRUE(mesh.triangles[0] == (Triangle{0, 1, 2}) || mesh.triangles[0] == (Triangle{2, 3, 0}));
}

TEST(ReadMesh, RefusesWhatItCannotRead) {
  EXPECT_NE(complaint([] { read_mesh("no/such/file.off", 1); }).find("does not exist"), std::string::npos);
  expect_refused("mesh.txt", "OFF\n", ".off, .obj, .stl or .ply");
  expect_refused("garbage.off", "this is not a mesh\n", "cannot be read");
  expect_refused("cut.off", off(unit_box()).substr(0, 60), "do not fit into the file's 60 bytes");
  expect_refused("empty.off", "OFF\n0 0 0\n", "empty");
  expect_refused("points.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "empty");
  expect_refused("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "cannot be read");
  expect_refused("index.ply", quads_ply.substr(0, quads_ply.size() - 10) + "4 4 5 7 60\n", "does not exist");
  expect_refused("bow.off", "OFF\n4 1 0\n0 0 0\n1 1 0\n1 0 0\n0 1 0\n4 0 1 2 3\n", "triangulated");
}

TEST(Solid, AcceptsTheLiver) {
  const std::string path = support::checkout() + "/params/meshes/liver_25k.off";
  const TriangleMesh mesh = require_solid(read_mesh(path, 0.001), path);
  EXPECT_EQ(mesh.triangles.size(), 25000u);
  EXPECT_GT(volume(mesh), 0);
}

TEST(Solid, FlipsWhatIsInsideOut) { EXPECT_DOUBLE_EQ(volume(require_solid(inside_out(unit_box()), "")), 1); }

TEST(Solid, OrientsTrianglesOneByOne) {
  TriangleMesh mesh = sphere_mesh(1, Vec3::Zero(), 3);
  const double expected = volume(mesh);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
    std::swap(mesh.triangles[i][0], mesh.triangles[i][1]);
  EXPECT_DOUBLE_EQ(volume(require_solid(mesh, "")), expected);
}

TEST(Solid, ShellsInsideShellsAreVoids) {
  const TriangleMesh outer = box_mesh({0, 0, 0}, {4, 4, 4}), middle = box_mesh({1, 1, 1}, {3, 3, 3}),
                     inner = box_mesh({1.5, 1.5, 1.5}, {2.5, 2.5, 2.5}), beside = box_mesh({5, 0, 0}, {6, 1, 1});
  const TriangleMesh mesh = together(together(together(inner, middle), inside_out(outer)), inside_out(beside));
  EXPECT_DOUBLE_EQ(volume(require_solid(mesh, "")), 64 - 8 + 1 + 1);
}

TEST(Solid, RefusesEachDefectByName) {
  expect_complaint({}, "empty");

  TriangleMesh open = unit_box();
  open.triangles.pop_back();
  expect_complaint(open, "boundary edges with one triangle only: 3, the first at (");

  TriangleMesh fin = unit_box();
  fin.vertices.emplace_back(-1, -1, 0.5);
  fin.triangles.push_back({0, 4, 8});
  expect_complaint(fin, "edges with more than two triangles: 1, the first at (0, 0, 0.5) m");

  TriangleMesh pinched = together(unit_box(), box_mesh({1, 1, 1}, {2, 2, 2}));
  for (Triangle& triangle : pinched.triangles)
    for (std::uint32_t& v : triangle)
      v = v == 8 ? 7 : v;
  expect_complaint(pinched, "vertices where surfaces touch in a point: 1, the first at (1, 1, 1) m");

  TriangleMesh degenerate = unit_box();
  degenerate.vertices[1] = degenerate.vertices[0];
  expect_complaint(degenerate, "degenerate triangles");

  expect_complaint(together(unit_box(), box_mesh({0.5, 0.5, 0.5}, {2, 2, 2})), "intersects itself: ");

  TriangleMesh flat{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}, {0, 2, 1}}};
  expect_complaint(flat, "does not bound a volume");
}

/// The projective plane with six vertices, in space as it comes: closed and manifold, but one-sided.
TEST(Solid, RefusesOneSidedSurfaces) {
  TriangleMesh mesh{
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 2}, {2, 1, 1}},
    {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1}, {1, 2, 4}, {2, 3, 5}, {3, 4, 1}, {4, 5, 2}, {5, 1, 3}}};
  expect_complaint(mesh, "not orientable");
}

TEST(Solid, SelfIntersectionsArePairs) {
  TriangleMesh mesh = together(unit_box(), box_mesh({0.25, 0.25, 0.5}, {0.75, 0.75, 2}));
  const auto pairs = self_intersections(mesh);
  ASSERT_FALSE(pairs.empty());
  for (const auto& [i, j] : pairs) {
    EXPECT_LT(i, 12u);
    EXPECT_GE(j, 12u);
  }
  EXPECT_TRUE(self_intersections(sphere_mesh(1, Vec3::Zero(), 3)).empty());
}

} // namespace
} // namespace kerf::geometry::triangle_mesh_test
