#pragma once

/// A file that changes by whole transactions, so that a kill or a full disk never leaves it half changed.
///
/// HDF5 flushes by writing many small blocks of metadata; a kill in between leaves a file that nobody can open. Here,
/// what lies below the committed end is never touched before the commit: changed pages wait in memory. What lies above
/// is written at once; nothing committed refers to it. A commit reserves the space, writes the changed pages behind
/// everything else as a redo journal (pages, their numbers, at the very end of the file a trailer with a checksum),
/// copies them into place and strikes the trailer out. `recover` repeats the copying when it finds a trailer. The space
/// of the journal is kept for the next one until the file is closed. Compare write-ahead logging, Mohan et al. 1992.
///
/// Limits: safe against the death of the process, not against a loss of power (nothing calls fsync); one writer at a
/// time, ensured by a lock. A foreign reader that opens the file while pages are copied may see some of them old; our
/// Reader repairs that. A file size limit (ulimit -f) shows as a full disk only where the signal SIGXFSZ is ignored.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace kerf::output {

class JournaledFile {
 public:
  static constexpr std::size_t page_size = 4096;

  enum class Mode { create, modify };

  /// Creates (or empties) a file, or opens an existing one behind its recovery. Throws DataError.
  JournaledFile(const std::filesystem::path& path, Mode mode);
  ~JournaledFile();
  JournaledFile(const JournaledFile&) = delete;
  JournaledFile& operator=(const JournaledFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// As far as anything has been written, committed or not [bytes].
  std::uint64_t size() const { return size_; }

  /// Fills `bytes`; what lies behind the end of the file reads as zero. Throws DataError.
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Never throws for a full disk: the failure shows at the commit, and till then reads see what was written.
  void write(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Makes the file at least this long.
  void grow(std::uint64_t size) { size_ = size > size_ ? size : size_; }

  /// Makes everything written so far durable, in a file of `size` bytes. Throws DataError when the disk is full; then
  /// the file is as after the commit before, and every later commit throws too.
  void commit(std::uint64_t size);
  /// Gives up what was written since the last commit; reads still see it, later commits throw `reason`.
  void abandon(const std::string& reason);
  bool abandoned() const { return !failure_.empty(); }

 private:
  struct Page {
    std::vector<std::byte> bytes;
    bool changed = false; ///< differs from the disk: HDF5 writes whole chunks where a row was added
  };

  Page& page(std::uint64_t number);
  void write_to_pages(std::uint64_t offset, std::span<const std::byte> bytes);
  void write_behind(std::uint64_t offset, std::span<const std::byte> bytes);
  void reserve(std::uint64_t end);
  std::uint64_t write_journal(std::uint64_t size);
  std::string describe(int error, std::uint64_t wanted) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t committed_ = 0; ///< committed end [bytes]
  std::uint64_t size_ = 0;
  std::uint64_t reserved_ = 0;                    ///< up to here our own writes have taken space on the disk [bytes]
  std::unordered_map<std::uint64_t, Page> pages_; ///< written and not yet committed, by number
  std::string failure_;                           ///< why no more is taken
};

/// Finishes a commit that was cut short, if there is one. Throws DataError when the file cannot be opened.
void recover(const std::filesystem::path& path);

} // namespace kerf::output
