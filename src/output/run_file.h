#pragma once

/// The one file of a run, in HDF5: what was run, the series over time, and the frames of every body.
///
///     /                    attributes: version, git_commit, command_line, ..., outcome; n_resumed: how often it went
///                          on after an early end; has_checkpoint: whether there is one beside it to go on from, 1 or 0
///     /scene               the whole text of the scene, overrides in place, names of files absolute
///     /inputs              the files that it reads, a line each: SHA-256, path
///     /composition         what was composed and what was left out, a line each
///     /time /step          one entry per output step
///     /timing/STAGE        seconds since the output step before
///     /observables/NAME    attributes unit and source
///     /bodies/NAME/complex/I, surface/I    only where the topology changed
///     /bodies/NAME/colours                 samples of revealed triangles, where the scene says what is inside; see
///     surface/I
///     /bodies/NAME/slopes                  of each of these samples, where the inside has a relief
///     /bodies/NAME/frames/I                position, velocity, fields; attributes time, step, complex;
///                                          links to its complex and surface
///     /failure             when the run ended early
///
/// Each append is one transaction (journaled_file.h): after a kill or on a full disk the file holds all output steps
/// that were appended, whole, and nothing of the next. Positions of the surface are not stored: they are W x_corners.
/// Limit: HDF5 is not thread safe; one thread at a time uses this room.

#include "output/records.h"

#include <filesystem>
#include <memory>

namespace kerf::output {

class RunFile {
 public:
  /// Creates the file, or empties it. Throws DataError when it cannot be written.
  RunFile(const std::filesystem::path& path, const RunInfo& info, const Schema& schema);
  /// Opens the file of an earlier run, to go on behind its last output step; what it says of an early end goes. Throws
  /// DataError.
  explicit RunFile(const std::filesystem::path& path);
  RunFile(RunFile&&) noexcept;
  RunFile& operator=(RunFile&&) noexcept;
  ~RunFile();

  void write_scene(const std::string& text);
  void write_inputs(const std::vector<std::string>& lines);
  void write_composition(const std::vector<std::string>& lines);

  /// Appends one output step and makes it durable. Throws DataError when it does not fit the schema or the disk; after
  /// a full disk the file stays as it was and takes no more.
  void append(const StepRecord& record);

  /// The steps that the file holds, and the values of an observable in each.
  std::vector<std::int64_t> steps() const;
  std::vector<double> observable(const std::string& name) const;
  const Schema& schema() const;

  /// A checkpoint stands beside the file now.
  void note_checkpoint();

  /// And has none any more.
  void complete();
  void fail(const Failure& failure);
  /// The same for an end that a signal has asked for.
  void interrupt(const Failure& failure);

 private:
  struct Contents;
  void end(const Failure& failure, Outcome outcome);
  std::unique_ptr<Contents> contents_;
};

} // namespace kerf::output
