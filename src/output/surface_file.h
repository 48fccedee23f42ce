#pragma once

/// The moving surface as one file that ParaView opens: VTKHDF 2.0, PolyData with Steps.
///
/// Each step appends its points [m] as 32-bit floats. Triangles, rest positions and labels are appended only when the
/// topology changed; other steps point back at the last ones. Fields at the vertices come with
/// each step. Each append is one transaction, as in run_file.h.
/// Source: VTKHDF format specification, docs.vtk.org (vtk_file_formats/vtkhdf_file_format).
/// Limit: one partition, one body a file.

#include "output/records.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

namespace kerf::output {

enum class Topology { unchanged, changed };

/// A surface at one time. With an unchanged topology only time and positions are read.
struct SurfaceStep {
  double time = 0;                      ///< [s]
  std::span<const Vec3> positions;      ///< per vertex [m], current configuration
  std::span<const Vec3> rest_positions; ///< per vertex [m], rest configuration
  std::span<const Triangle> triangles;
  std::span<const std::uint16_t> labels; ///< per triangle: which cut revealed it
  Topology topology = Topology::changed;
  std::span<const Field> fields = {}; ///< per vertex: those that the file was made for
};

class SurfaceFile {
 public:
  /// Creates the file, or empties it. `fields` are the names, units and components of what every step brings. Throws
  /// DataError when it cannot be written.
  explicit SurfaceFile(const std::filesystem::path& path, std::span<const Field> fields = {});
  /// Opens the file of an earlier run that was made for the same fields, to go on behind its last step. Throws
  /// DataError.
  static SurfaceFile go_on(const std::filesystem::path& path, std::span<const Field> fields = {});
  SurfaceFile(SurfaceFile&&) noexcept;
  SurfaceFile& operator=(SurfaceFile&&) noexcept;
  ~SurfaceFile();

  /// Appends one step and makes it durable. Throws DataError when sizes do not fit, or the disk is full.
  void append(const SurfaceStep& step);

  /// Of the last step [s]; none before the first.
  std::optional<double> last_time() const;

 private:
  struct Contents;
  explicit SurfaceFile(std::unique_ptr<Contents> contents);
  std::unique_ptr<Contents> contents_;
};

} // namespace kerf::output
