#pragma once

/// Reads back a run's file (run_file.h): for tests, studies, and runs that go on from a frame.

#include "output/records.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace kerf::output {

/// All members throw DataError, with file and dataset, when what they are asked for is not there or cannot be read.
class Reader {
 public:
  /// Opens for reading. Finishes the last transaction when the writer was killed in the middle of it.
  explicit Reader(const std::filesystem::path& path);
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();

  RunInfo info() const;
  Outcome outcome() const;
  std::optional<Failure> failure() const;
  std::string scene() const;
  bool has_scene() const;                  ///< none: the run was killed before its first step
  bool has_checkpoint() const;             ///< whether one was written that should still stand beside the file
  std::vector<std::string> inputs() const; ///< SHA-256 and path of each file that the scene reads
  std::vector<std::string> composition() const;
  Schema schema() const;

  std::size_t n_steps() const;
  std::vector<double> times() const; ///< [s]
  std::vector<std::int64_t> steps() const;
  std::vector<double> observable(const std::string& name) const;
  std::vector<double> timing(const std::string& stage) const; ///< [s]

  std::vector<std::string> bodies() const;
  std::size_t n_frames(const std::string& body) const;
  Frame frame(const std::string& body, std::size_t index) const;
  std::size_t n_complexes(const std::string& body) const;
  Complex complex(const std::string& body, std::size_t index) const;
  std::size_t n_surfaces(const std::string& body) const;
  Surface surface(const std::string& body, std::size_t index) const;

  /// A text attribute of any object: attribute("/observables/volume", "unit").
  std::string attribute(const std::string& object, const std::string& name) const;

 private:
  struct Contents;
  std::unique_ptr<Contents> contents_;
};

} // namespace kerf::output
