#pragma once

/// A folder that one run at a time writes into, and that remembers what is Kerf's in it.
///
/// FOLDER/.kerf lists the names that Kerf has made there, and says which process is at work. Only what it lists is ever
/// deleted or replaced; a file of such a name that it does not list is somebody else's, and refused. While a run goes
/// on the file is locked (an open file description's lock, fcntl F_OFD_SETLK), so a second run is refused before it
/// touches anything; the lock ends with the process, however that ends. On NFS the lock is the server's (version 4, or
/// version 3 with its lock daemon), so other nodes see it, and where a node dies the server keeps it until its lease
/// ends, about 90 s. On a file system without locks nobody is refused.

#include <filesystem>
#include <string>
#include <vector>

namespace kerf::output {

/// What to do about the results of an earlier run.
enum class Earlier { refuse, replace, resume };

/// Throws what claiming the folder would throw as far as can be known, and makes nothing: for whoever would know before
/// a long preparation.
void require_claimable(const std::filesystem::path& folder, Earlier earlier);

class ResultsFolder {
 public:
  /// Makes the folder and takes it. `names` are what the run will make in it, relative to it: "run.h5"; "frames/*.png"
  /// stands for all whose names are digits. To replace, what an earlier run made is deleted first. Throws DataError
  /// where it cannot be made, is in use, or holds a file of such a name that is not Kerf's; ParameterError where it
  /// holds results and nobody said what to do about them.
  ResultsFolder(std::filesystem::path folder, Earlier earlier, const std::vector<std::string>& names);
  /// Gives the folder back.
  ~ResultsFolder();
  ResultsFolder(const ResultsFolder&) = delete;
  ResultsFolder& operator=(const ResultsFolder&) = delete;

  const std::filesystem::path& path() const { return folder_; }

 private:
  void write_list(const std::vector<std::string>& names, const std::string& holder) const;

  std::filesystem::path folder_;
  std::vector<std::string> names_;
  int descriptor_ = -1;
};

} // namespace kerf::output
