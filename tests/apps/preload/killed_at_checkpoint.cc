// Loaded before the C library: ends the process as kill -9 does, in the middle of writing a checkpoint. KERF_KILL names
// the moment, and the number of the checkpoint, from 1: "write 2" (half of what is to be written is), "fsync 2",
// "rename 2" (before), "renamed 2" (after).

#include <dlfcn.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

constexpr std::string_view beside = "checkpoint.kerf.new";

template <class Function>
Function* next(const char* const name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

bool is_checkpoint(const int descriptor) {
  std::array<char, 4096> path{};
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const auto n = readlink(link.c_str(), path.data(), path.size());
  return n > 0 && std::string_view(path.data(), static_cast<std::size_t>(n)).ends_with(beside);
}

/// Whether it is the moment; counts how often it was asked for each.
bool is_time_for(const std::string& moment, int& n) {
  const char* const wanted = std::getenv("KERF_KILL");
  return wanted && wanted == moment + " " + std::to_string(++n);
}

} // namespace

extern "C" ssize_t write(const int descriptor, const void* const bytes, const std::size_t n) {
  static int times = 0;
  const auto really = next<ssize_t(int, const void*, std::size_t)>("write");
  if (n > 8 && is_checkpoint(descriptor) && is_time_for("write", times)) { // not the checksum alone
    really(descriptor, bytes, n / 2);
    raise(SIGKILL);
  }
  return really(descriptor, bytes, n);
}

extern "C" int fsync(const int descriptor) {
  static int times = 0;
  if (is_checkpoint(descriptor) && is_time_for("fsync", times))
    raise(SIGKILL);
  return next<int(int)>("fsync")(descriptor);
}

extern "C" int rename(const char* const from, const char* const to) noexcept {
  static int times = 0, times_after = 0;
  const bool is_it = std::string_view(from).ends_with(beside);
  if (is_it && is_time_for("rename", times))
    raise(SIGKILL);
  const int result = next<int(const char*, const char*)>("rename")(from, to);
  if (is_it && is_time_for("renamed", times_after))
    raise(SIGKILL);
  return result;
}
