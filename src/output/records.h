#pragma once

/// What goes into a run's file and comes out of it again: plain records, the same for writing and reading.

#include "base/interpolation.h"
#include "base/timer.h"
#include "base/vec.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace kerf::output {

struct Library {
  std::string name, version;
};

/// Where a run comes from; enough to repeat it.
struct RunInfo {
  std::string version;
  std::string git_commit;
  std::string command_line;
  std::string host;
  std::string compiler;
  std::vector<Library> libraries;
  int n_threads = 1;
  std::uint64_t seed = 0;
  std::string started; ///< ISO 8601
};

struct Observable {
  std::string name;
  std::string unit;   ///< "[J]"; "[1]" when dimensionless
  std::string source; ///< how it is computed, or where its definition stands
};

/// The series of a run, fixed when its file is created.
struct Schema {
  std::vector<std::string> stages; ///< of which the seconds are kept
  std::vector<Observable> observables;
};

/// Per corner values that a model needs beside position and velocity to go on; n_corners x n_components, row by row.
struct Field {
  std::string name;
  std::string unit;
  std::size_t n_components = 1;
  std::vector<double> values;
};

/// The copies of a body's cells (grid/complex.h), as arrays.
struct Complex {
  std::vector<std::array<std::uint32_t, 8>> corners; ///< per copy
  std::vector<Index3> cells;                         ///< per copy: lattice index of its cell
  std::vector<std::uint8_t> nodes;                   ///< per copy: bits of its material nodes
  std::vector<std::uint32_t> skin;                   ///< per copy: bits of its points of the skin, where blades cut that
  Points rest_positions;            ///< per corner [m], rest configuration
};

/// Colours of revealed triangles, finer than the triangles: triangle t has (n + 1)(n + 2) / 2 samples from first[t] on,
/// n = parts[t], at the points a + i/n (b - a) + j/n (c - a) of the triangle a, b, c, i slower than j. Samples are only
/// ever appended, so those of earlier surfaces stay as they are.
struct Colours {
  std::vector<std::uint32_t> first;                 ///< per triangle; 2^32 - 1 without samples
  std::vector<std::uint16_t> parts;                 ///< per triangle; 0 without samples
  std::vector<std::array<std::uint8_t, 3>> samples; ///< sRGB: those that the file does not have yet
  std::vector<std::array<float, 2>>
    slopes; ///< [m] of each of these: by how much a relief rises along (b - a), (c - a);
            ///< empty in a body without relief
};

/// A body's closed surface; it follows the corners by x_surface = W x_corners.
struct Surface {
  std::vector<Triangle> triangles;
  std::vector<std::uint16_t> labels; ///< per triangle: which cut revealed it, 0 for the skin
  Points rest_positions;             ///< per vertex [m], rest configuration
  Interpolation weights;             ///< W [1], vertices x corners
};

/// One body at one output step, for writing.
struct BodyStep {
  std::string body;
  std::span<const Vec3> positions;  ///< per corner [m], current configuration
  std::span<const Vec3> velocities; ///< per corner [m/s]; may be empty
  std::span<const Field> fields;    ///< may be empty
  const Complex* complex = nullptr; ///< null when unchanged since the body's last frame
  const Surface* surface = nullptr; ///< null when unchanged or not wanted
  const Colours* colours = nullptr; ///< of that surface; null when it has none
};

/// One output step, for writing.
struct StepRecord {
  double time = 0; ///< [s]
  std::int64_t step = 0;
  Timings seconds;                     ///< per stage [s], since the last output step; a stage left out counts as 0
  std::span<const double> observables; ///< in the order of the schema
  std::vector<BodyStep> bodies;        ///< those that write a frame now
};

/// One body at one output step, as read back.
struct Frame {
  double time = 0; ///< [s]
  std::int64_t step = 0;
  std::size_t complex = 0; ///< index of the complex it belongs to
  Points positions;        ///< per corner [m], current configuration
  Points velocities;       ///< per corner [m/s]; empty when none were written
  std::vector<Field> fields;
};

enum class Outcome {
  running, ///< or killed
  completed,
  failed,
  interrupted ///< by a signal, between two steps
};

/// Why and when a run ended early.
struct Failure {
  std::string text;
  std::int64_t step = 0;
  double time = 0; ///< [s]
};

} // namespace kerf::output
