#pragma once

/// A surface that changes with time, and a reader that follows the VTKHDF specification and nothing else.

#include "output/h5_array.h"
#include "output/surface_file.h"
#include "tests/output/samples.h"

namespace kerf::output {

struct SampleSurface {
  Points positions, rest_positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint16_t> labels;
};

/// At step i: a fan of triangles; its topology changes every third step.
inline SampleSurface surface_at(const std::size_t i) {
  const auto n = static_cast<std::uint32_t>(200 + 10 * (i / 3));
  SampleSurface surface = {sample_points(n + 2, i), sample_points(n + 2, i / 3), {}, {}};
  for (std::uint32_t t = 0; t < n; ++t) {
    surface.triangles.push_back({0, t + 1, t + 2});
    surface.labels.push_back(static_cast<std::uint16_t>(t % 7 + i / 3));
  }
  return surface;
}

inline void append_surface(SurfaceFile& file, const std::size_t i) {
  const auto surface = surface_at(i);
  const auto topology = i % 3 == 0 ? Topology::changed : Topology::unchanged;
  file.append(
    {0.5 * double(i), surface.positions, surface.rest_positions, surface.triangles, surface.labels, topology});
}

class SurfaceReader {
 public:
  explicit SurfaceReader(const std::filesystem::path& path) : root_(h5::open_read_only(path)) {}

  std::size_t n_steps() const {
    return static_cast<std::size_t>(h5::integer_attribute(h5::open_group(root_, "/VTKHDF/Steps"), "NSteps"));
  }
  double time(const std::size_t i) const { return column<double>("Steps/Values").at(i); }

  /// Whether step i is `expected`, to single precision.
  bool holds(const SampleSurface& expected, const std::size_t i) const {
    const auto part = count("Steps/PartOffsets", i);
    const auto n_points = count("NumberOfPoints", part);
    const auto n_triangles = count("Polygons/NumberOfCells", part);
    return time(i) == 0.5 * double(i) && n_points == expected.positions.size() &&
           n_triangles == expected.triangles.size() && count("Steps/NumberOfParts", i) == 1 &&
           same_points("Points", count("Steps/PointOffsets", i), expected.positions) &&
           same_points("PointData/rest_position", count("Steps/PointDataOffsets/rest_position", i),
                       expected.rest_positions) &&
           same_labels(count("Steps/CellDataOffsets/label", i), expected.labels) &&
           same_triangles(polygon_column("Steps/CellOffsets", i) + part,
                          polygon_column("Steps/ConnectivityIdOffsets", i), expected.triangles);
  }

 private:
  template <class T>
  std::vector<T> column(const std::string& name) const {
    return h5::read_vector<T>(root_, "/VTKHDF/" + name);
  }
  std::size_t count(const std::string& name, const std::size_t i) const {
    return static_cast<std::size_t>(column<std::int64_t>(name).at(i));
  }
  std::size_t polygon_column(const std::string& name, const std::size_t i) const { return count(name, 4 * i + 2); }

  bool same_points(const std::string& name, const std::size_t first, const Points& expected) const {
    const auto numbers = column<float>(name);
    for (std::size_t k = 0; k < 3 * expected.size(); ++k)
      if (numbers.at(3 * first + k) != static_cast<float>(expected[k / 3][k % 3]))
        return false;
    return true;
  }
  bool same_labels(const std::size_t first, const std::vector<std::uint16_t>& expected) const {
    const auto labels = column<std::uint16_t>("CellData/label");
    for (std::size_t k = 0; k < expected.size(); ++k)
      if (labels.at(first + k) != expected[k])
        return false;
    return true;
  }
  bool same_triangles(const std::size_t first, const std::size_t first_id,
                      const std::vector<Triangle>& expected) const {
    const auto offsets = column<std::int64_t>("Polygons/Offsets"), ids = column<std::int64_t>("Polygons/Connectivity");
    for (std::size_t t = 0; t < expected.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        if (offsets.at(first + t + 1) - offsets.at(first + t) != 3 ||
            ids.at(first_id + static_cast<std::size_t>(offsets.at(first + t)) + k) != expected[t][k])
          return false;
    return true;
  }

  h5::Object root_;
};

} // namespace kerf::output
