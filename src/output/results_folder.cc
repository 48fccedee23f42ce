#include "output/results_folder.h"

#include "base/error.h"

#include <fcntl.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>

namespace kerf::output {

namespace fs = std::filesystem;

namespace {

using Names = std::vector<std::string>;

const std::string list_name = ".kerf", nobody = "nobody", title = "Kerf made these, and may replace them; at work: ";
const std::string frames = "frames/*.png";

[[noreturn]] void refuse(const fs::path& folder, const std::error_code& error) {
  throw DataError(Complaint{.file = folder.string(),
                            .rule = "the results folder cannot be made: " + error.message(),
                            .remedy = error == std::errc::not_a_directory
                                        ? "Choose another folder with --output: a part of this path is a file"
                                        : "Choose another folder with --output, or change its permissions"});
}

struct List {
  Names names;
  std::string holder = nobody;
};

List read_list(const fs::path& folder) {
  std::ifstream in(folder / list_name);
  List list;
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(title))
      list.holder = line.substr(title.size());
    else if (!line.empty())
      list.names.push_back(line);
  return list;
}

bool is_numbered(const fs::path& file) {
  const std::string stem = file.stem().string();
  return file.extension() == ".png" && !stem.empty() &&
         std::all_of(stem.begin(), stem.end(), [](const unsigned char c) { return std::isdigit(c); });
}

/// Whether a picture carries the mark that render/image.cc writes, or was left empty by a kill.
bool is_ours(const fs::path& picture) {
  const std::string mark("tEXtSoftware\0Kerf", 17);
  std::array<char, 64> head{};
  std::ifstream in(picture, std::ios::binary);
  in.read(head.data(), head.size());
  const std::string_view read(head.data(), static_cast<std::size_t>(in.gcount()));
  return read.empty() || read.find(mark) != std::string_view::npos;
}

/// The files that a name stands for, as they are now.
std::vector<fs::path> files_of(const fs::path& folder, const std::string& name) {
  std::error_code ignored;
  if (name != frames)
    return fs::exists(fs::symlink_status(folder / name, ignored)) ? std::vector{folder / name}
                                                                  : std::vector<fs::path>{};
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder / fs::path(frames).parent_path(), ignored))
    if (is_numbered(entry.path()))
      found.push_back(entry.path());
  return found;
}

bool holds(const fs::path& folder, const Names& names) {
  return std::any_of(names.begin(), names.end(), [&](const auto& name) { return !files_of(folder, name).empty(); });
}

/// True when this descriptor has the lock, or the file system has no locks.
bool lock(const int descriptor) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return fcntl(descriptor, F_OFD_SETLK, &whole) == 0 || (errno != EAGAIN && errno != EACCES);
}

[[noreturn]] void refuse_in_use(const fs::path& folder) {
  const std::string holder = read_list(folder).holder;
  throw DataError(Complaint{.file = folder.string(),
                            .rule = "is in use: " + (holder == nobody ? "another run" : holder) + " writes into it",
                            .remedy = "Wait until it has ended, or choose another folder with --output"});
}

void require_no_results(const fs::path& folder, const Earlier earlier) {
  if (earlier == Earlier::refuse && holds(folder, read_list(folder).names))
    throw ParameterError(Complaint{.file = folder.string(),
                                   .rule = "holds the results of an earlier run",
                                   .remedy = "Replace them with --force, go on from where they end with --resume, or "
                                             "choose another folder with --output"});
}

void require_no_strangers(const fs::path& folder, const Names& names) {
  const Names ours = read_list(folder).names;
  const auto refuse_stranger = [](const fs::path& file, const std::string& why) {
    throw DataError(Complaint{.file = file.string(),
                              .rule = "would be overwritten, and is not known to be Kerf's: " + why,
                              .remedy = "Move it away, or choose another folder with --output"});
  };
  for (const std::string& name : names) {
    const bool is_listed = std::find(ours.begin(), ours.end(), name) != ours.end();
    for (const fs::path& file : files_of(folder, name))
      if (!is_listed)
        refuse_stranger(file, (folder / list_name).string() + " does not list it");
      else if (name == frames && !is_ours(file))
        refuse_stranger(file, "it does not carry Kerf's mark");
  }
}

/// The folder itself, or what it would have to be made in.
fs::path nearest_existing(const fs::path& folder) {
  std::error_code error;
  fs::path place = fs::absolute(folder);
  while (!fs::exists(place, error) && place.has_relative_path())
    place = place.parent_path();
  return place;
}

std::string this_process() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return "process " + std::to_string(getpid()) + " on " + host.data();
}

} // namespace

void require_claimable(const fs::path& folder, const Earlier earlier) {
  const fs::path place = nearest_existing(folder);
  std::error_code error;
  if (!fs::is_directory(place, error))
    refuse(folder, error ? error : std::make_error_code(std::errc::not_a_directory));
  if (access(place.c_str(), W_OK | X_OK) != 0)
    refuse(folder, std::error_code(errno, std::generic_category()));
  if (const int descriptor = open((folder / list_name).c_str(), O_RDWR | O_CLOEXEC); descriptor >= 0) {
    const bool is_free = lock(descriptor);
    close(descriptor);
    if (!is_free)
      refuse_in_use(folder);
  }
  require_no_results(folder, earlier);
  require_no_strangers(folder, {"run.h5", "study.h5"});
}

ResultsFolder::ResultsFolder(fs::path folder, const Earlier earlier, const Names& names)
  : folder_(std::move(folder)), names_(names) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error)
    refuse(folder_, error);
  const bool is_new = !fs::exists(folder_ / list_name, error);
  descriptor_ = open((folder_ / list_name).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0)
    refuse(folder_, std::error_code(errno, std::generic_category()));
  try {
    if (!lock(descriptor_))
      refuse_in_use(folder_);
    require_no_results(folder_, earlier);
    require_no_strangers(folder_, names);
    Names all = read_list(folder_).names; // of both runs, until the earlier one's are gone
    all.insert(all.end(), names.begin(), names.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    write_list(all, this_process());
    if (earlier == Earlier::replace)
      for (const std::string& name : all)
        for (const fs::path& file : files_of(folder_, name))
          if (name != frames || is_ours(file))
            fs::remove(file, error); // what cannot be removed is overwritten, or its writer says why not
    if (earlier != Earlier::resume)
      write_list(names_, this_process());
    else
      names_ = all;
  } catch (...) {
    if (is_new)
      fs::remove(folder_ / list_name, error);
    close(descriptor_);
    throw;
  }
}

ResultsFolder::~ResultsFolder() {
  try {
    write_list(names_, nobody);
  } catch (const DataError&) {
    // the lock ends all the same, and the names are those that stand there
  }
  close(descriptor_);
}

void ResultsFolder::write_list(const Names& names, const std::string& holder) const {
  std::string text = title + holder + "\n";
  for (const std::string& name : names)
    text += name + "\n";
  errno = ENOSPC; // of a write that takes a part
  if (pwrite(descriptor_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()) ||
      ftruncate(descriptor_, static_cast<off_t>(text.size())) != 0)
    throw DataError(Complaint{.file = (folder_ / list_name).string(),
                              .rule = "cannot be written: " + std::generic_category().message(errno),
                              .remedy = "Free disk space or raise the quota, or choose another folder with --output"});
}

} // namespace kerf::output
