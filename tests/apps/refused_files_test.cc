// Files that cannot be read, used or written: exit code 2, and what was written before stays readable.

#include "output/reader.h"
#include "tests/apps/program.h"
#include "tests/geometry/meshes.h"

namespace kerf::apps::refused_files_test {
namespace {

class RefusedFile : public Program {
 protected:
  /// A scene with this mesh is refused, at the line that names it.
  void expect_mesh_refused(const std::string& mesh, const Words& parts) const {
    const std::string scene = replaced(cube_scene(), mesh_path("cube.off"), mesh);
    expect_error(run(scene), 2, parts);
    expect_error(run(scene), 2,
                 {"scene.prm:" + std::to_string(line_of(scene, "Mesh")) + ": Body cube/Mesh = '" + mesh + "'"});
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  }
};

TEST_F(RefusedFile, SceneThatIsNotThere) {
  expect_error(kerf({"run", "nosuch.prm"}), 2, {"nosuch.prm", "cannot be read", "Give the path of a .prm file"});
  expect_error(kerf({"check", "."}), 2, {".", "cannot be read"});
}

TEST_F(RefusedFile, MeshThatIsNotThere) {
  expect_mesh_refused("nosuch.off", {"nosuch.off", "does not exist", "Check the path"});
  expect_mesh_refused("scene.prm", {"must end in .off, .obj, .stl or .ply", "Convert"});
}

TEST_F(RefusedFile, MeshThatIsOpen) {
  geometry::TriangleMesh mesh = geometry::box_mesh(Vec3::Constant(-0.1), Vec3::Constant(0.1));
  mesh.triangles.pop_back();
  write_off(folder / "open.off", mesh);
  expect_mesh_refused("open.off", {"open.off", "it is open", "3, the first at", "Fill the holes"});
}

TEST_F(RefusedFile, MeshThatIntersectsItself) {
  const auto one = geometry::box_mesh(Vec3::Constant(-0.1), Vec3::Constant(0.1));
  write_off(folder / "twice.off",
            geometry::together(one, geometry::box_mesh(Vec3::Constant(-0.03), Vec3::Constant(0.17))));
  expect_mesh_refused("twice.off", {"twice.off", "intersects itself", "pairs of triangles", "Repair it"});
}

TEST_F(RefusedFile, MeshThatIsEmptyOrNoMesh) {
  write("empty.off", "OFF\n0 0 0\n");
  expect_mesh_refused("empty.off", {"empty.off", "mesh", "Open it in a mesh viewer"});
  write("nothing.off", "");
  expect_mesh_refused("nothing.off", {"nothing.off", "mesh", "Open it in a mesh viewer"});
  write("text.stl", "This is no mesh.\n");
  expect_mesh_refused("text.stl", {"text.stl", "mesh", "Open it in a mesh viewer"});
}

TEST_F(RefusedFile, ResultsBelowAFile) {
  write("file", "no folder");
  write("scene.prm", cube_scene());
  expect_error(kerf({"run", "scene.prm", "--output", "file/out"}), 2,
               {"file/out", "results folder cannot be made", "Choose another folder with --output"});
  expect_error(kerf({"run", "scene.prm", "--output", "file"}), 2, {"file", "results folder"});
  write("scene.prm", replaced(cube_scene(), mesh_path("cube.off"), "nosuch.off"));
  const Result result = kerf({"run", "scene.prm", "--output", "file/out"});
  expect_error(result, 2, {"file/out", "results folder cannot be made"}); // before the scene is composed
  EXPECT_EQ(result.out, "");
}

/// A limit on the size of files stands for a full disk: the same error of the same call.
TEST_F(RefusedFile, DiskThatIsFull) {
  const std::string scene = cube_scene() + replaced(all_outputs(), "subsection Surface file\nend\n", "");
  for (const int blocks : {700, 1500}) { // of 512 bytes
    SCOPED_TRACE(blocks);
    const Result result = run(scene, {"--set", "Time/End time [s]=2"}, "ulimit -f " + std::to_string(blocks));
    expect_error(result, 2, {"out/run.h5", "cannot take", "what was written before is kept", "Free disk space"});
    const output::Reader reader(folder / "out/run.h5");
    const std::size_t n = reader.n_steps();
    EXPECT_GE(n, 2u);
    EXPECT_LT(n, 200u);
    EXPECT_EQ(reader.scene(), replaced(scene, "set End time [s]  = 0.05", "set End time [s] = 2 # --set"));
    EXPECT_EQ(reader.n_frames("cube"), n);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_EQ(reader.steps().at(i), static_cast<std::int64_t>(i));
      EXPECT_EQ(reader.frame("cube", i).positions.size(), 216u);
    }
    EXPECT_NE(reader.outcome(), output::Outcome::completed);
  }
}

TEST_F(RefusedFile, DiskThatIsFullForTheSurface) {
  const std::string scene = cube_scene() +
                            "subsection Surface file\n  set Every [1] = 1\nend\nsubsection Output\n"
                            "  set Frames every [1] = 1000\nend\n";
  const Result result = run(scene, {"--set", "Time/End time [s]=2"}, "ulimit -f 800");
  expect_error(result, 2, {"out/surface_cube.vtkhdf", "cannot take", "Free disk space"});
  const output::Reader reader(folder / "out/run.h5");
  EXPECT_EQ(reader.outcome(), output::Outcome::failed);
  ASSERT_TRUE(reader.failure());
  EXPECT_NE(reader.failure()->text.find("surface_cube.vtkhdf"), std::string::npos);
}

TEST_F(RefusedFile, MemoryThatIsUsedUp) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer itself needs more than the limit";
#endif
  const Result result = run(cube_scene(), {"--set", "Body cube/Cube edge [m]=0.0018"}, "ulimit -v 1000000");
  expect_error(result, 3, {"out of memory", "larger cube edge"});
}

/// Before any of it is taken.
TEST_F(RefusedFile, MoreCellsThanMemoryCanHold) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer itself needs more than the limit";
#endif
  expect_error(run(cube_scene(), {"--set", "Body cube/Cube edge [m]=0.0014"}, "ulimit -v 1000000"), 1,
               {"Body cube/Cube edge [m]", "at least 1.4", "GB of memory, and there are 1.02", "Use larger cubes"});
}

} // namespace
} // namespace kerf::apps::refused_files_test
