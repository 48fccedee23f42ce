#pragma once

/// What a run needs to go on after a step, as one file that is there whole or not at all: it is written beside the one
/// before, brought to the disk (fsync), and takes its name (rename). A kill at any moment leaves one of the two; a
/// checksum finds what a failing disk has made of it.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kerf::output {

struct Checkpoint {
  std::string program; ///< version and commit that wrote it
  std::string inputs;  ///< of the files that the scene reads: their hashes
  std::int64_t step = 0;
  std::vector<std::byte> state; ///< base/archive.h
};

/// Throws DataError when it cannot be written; then the one before is as it was.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// None where there is no such file. Throws DataError for one that is damaged or none of ours.
std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& path);

/// The name under which it is written before it takes its own.
std::filesystem::path name_beside(const std::filesystem::path& path);
/// Gives what was written beside its name, in place of what has it. Throws DataError.
void take_name(const std::filesystem::path& path);

} // namespace kerf::output
