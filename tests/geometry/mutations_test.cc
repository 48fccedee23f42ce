// Damaged meshes in this very process, so that the sanitizers see it: each is read, or refused with a word about its
// file.

#include "base/error.h"
#include "geometry/shapes.h"
#include "geometry/solid.h"
#include "tests/support/vandal.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include <unistd.h>

namespace kerf::geometry::mutations_test {
namespace {

std::string off(const TriangleMesh& mesh) {
  std::ostringstream out;
  out << "OFF\n" << mesh.vertices.size() << ' ' << mesh.triangles.size() << " 0\n";
  for (const Vec3& v : mesh.vertices)
    out << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
  for (const Triangle& t : mesh.triangles)
    out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  return out.str();
}

std::string obj(const TriangleMesh& mesh) {
  std::ostringstream out;
  for (const Vec3& v : mesh.vertices)
    out << "v " << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
  for (const Triangle& t : mesh.triangles)
    out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  return out.str();
}

std::string ply(const TriangleMesh& mesh) {
  std::ostringstream out;
  out << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string text = off(mesh);
  return out.str() + text.substr(text.find('\n', 4) + 1);
}

void put(std::string& bytes, const auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); }

std::string binary_stl(const TriangleMesh& mesh) {
  std::string bytes(80, ' ');
  put(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    bytes.append(12, '\0');
    for (const Vec3& corner : corners(mesh, i))
      for (int k = 0; k < 3; ++k)
        put(bytes, static_cast<float>(corner[k]));
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST(DamagedMeshes, AreReadOrRefused) {
  const TriangleMesh box = box_mesh({0, 0, 0}, {1, 2, 3}), ball = sphere_mesh(1, Vec3::Zero(), 1);
  const std::vector<std::pair<std::string, std::string>> files = {
    {"off", off(ball)}, {"obj", obj(box)}, {"ply", ply(ball)}, {"stl", binary_stl(box)}};
  for (const auto& [kind, whole] : files) {
    const auto path =
      std::filesystem::temp_directory_path() / ("kerf_damaged_" + std::to_string(getpid()) + "." + kind);
    std::size_t n_read = 0, n_refused = 0;
    for (unsigned seed = 0; seed < 300; ++seed) {
      std::ofstream(path, std::ios::binary) << support::Vandal(seed).damaged(whole);
      try {
        require_solid(read_mesh(path.string(), 1), path.string());
        ++n_read;
      } catch (const DataError& error) {
        EXPECT_NE(std::string(error.what()).find("kerf_damaged_"), std::string::npos) << kind << " " << seed;
        ++n_refused;
      }
    }
    std::filesystem::remove(path);
    EXPECT_GT(n_read, 0u) << kind;
    EXPECT_GT(n_refused, 100u) << kind;
  }
}

} // namespace
} // namespace kerf::geometry::mutations_test
