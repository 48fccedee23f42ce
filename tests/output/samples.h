#pragma once

/// What the tests of this room share: a folder that goes away, and records whose values follow from an index.

#include "output/records.h"

#include <unistd.h>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <string>

namespace kerf::output {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    static std::atomic<int> n_folders = 0;
    const auto name = "kerf-output-" + std::to_string(getpid()) + "-" + std::to_string(n_folders++);
    path_ = std::filesystem::temp_directory_path() / name;
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Hardly compressible, and different for every index.
inline Points sample_points(const std::size_t n, const std::size_t index) {
  Points points(n);
  for (std::size_t i = 0; i < n; ++i)
    points[i] = Vec3(std::sin(1e3 * double(i + 1) + double(index)), std::cos(double(i * index)), double(index));
  return points;
}

/// A complex of n copies that share nothing; it has 8 n corners.
inline Complex sample_complex(const std::size_t n, const std::size_t index) {
  Complex complex;
  for (std::uint32_t i = 0; i < n; ++i) {
    complex.corners.push_back({8 * i, 8 * i + 1, 8 * i + 2, 8 * i + 3, 8 * i + 4, 8 * i + 5, 8 * i + 6, 8 * i + 7});
    complex.cells.push_back({static_cast<int>(i), -1, static_cast<int>(index)});
    complex.nodes.push_back(static_cast<std::uint8_t>(i + index));
    complex.skin.push_back(static_cast<std::uint32_t>(300 * i + index));
  }
  complex.rest_positions = sample_points(8 * n, index);
  return complex;
}

/// A tetrahedron whose vertices are the corners 0, 1, 2 and the middle of 3 and 4.
inline Surface sample_surface() {
  return {.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
          .labels = {0, 0, 1, 2},
          .rest_positions = sample_points(4, 3),
          .weights = {{{0, 1, 2, 3, 5}, {0, 1, 2, 3, 4}, {1, 1, 1, 0.5, 0.5}}}};
}

inline RunInfo sample_info() {
  return {.version = "0.1.0",
          .git_commit = "0123abcd",
          .command_line = "kerf run scene.prm",
          .host = "host",
          .compiler = "gcc 12",
          .libraries = {{"Eigen", "3.4.0"}, {"deal.II", "9.4.1"}},
          .n_threads = 4,
          .seed = 0xfedcba9876543210u,
          .started = "2026-01-31T12:00:00Z"};
}

/// Neither list is in alphabetical order.
inline Schema sample_schema() {
  return {{"topology", "cut", "output"},
          {{"volume", "m^3", "sum over octants"}, {"energy", "J", "elastic and kinetic"}}};
}

} // namespace kerf::output
