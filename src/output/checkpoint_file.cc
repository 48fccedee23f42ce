#include "output/checkpoint_file.h"

#include "base/archive.h"
#include "output/checksum.h"

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <fstream>
#include <system_error>

namespace kerf::output {

namespace {

constexpr char format[] = "kerf checkpoint 1";

void transfer(Archive& a, Checkpoint& checkpoint) {
  a.name(format);
  a(checkpoint.program, checkpoint.inputs, checkpoint.step, checkpoint.state);
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& rule) {
  throw DataError(Complaint{.file = path.string(),
                            .rule = rule,
                            .remedy = "Free disk space, check the folder's permissions, or start again with --force"});
}

/// 0, or the error number.
int write_all(const int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const auto n = write(descriptor, bytes.data(), bytes.size());
    if (n < 0 && errno != EINTR)
      return errno;
    if (n > 0)
      bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return 0;
}

/// 0, or the error number. Some file systems cannot sync a folder; then its entries are as durable as they make them.
int write_durably(const std::filesystem::path& path, const std::vector<std::span<const std::byte>>& parts) {
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0)
    return errno;
  int error = 0;
  for (const auto& part : parts)
    error = error != 0 ? error : write_all(descriptor, part);
  if (error == 0 && fsync(descriptor) != 0)
    error = errno;
  close(descriptor);
  return error;
}

void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0)
    return;
  fsync(descriptor);
  close(descriptor);
}

} // namespace

std::filesystem::path name_beside(const std::filesystem::path& path) { return path.string() + ".new"; }

void take_name(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::rename(name_beside(path), path, error);
  if (error)
    refuse(path, "cannot be written: " + error.message());
}

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  Archive archive;
  Checkpoint copy = checkpoint;
  transfer(archive, copy);
  const std::uint64_t sum = checksum(first_checksum, archive.bytes());
  const auto beside = name_beside(path);
  if (const int error = write_durably(beside, {archive.bytes(), std::as_bytes(std::span(&sum, 1))}); error != 0) {
    std::error_code ignored;
    std::filesystem::remove(beside, ignored);
    refuse(path, "the checkpoint cannot be written: " + std::generic_category().message(error));
  }
  take_name(path);
  sync_folder(path.parent_path());
}

std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    return std::nullopt;
  std::ifstream in(path, std::ios::binary);
  std::vector<char> text(std::istreambuf_iterator<char>(in), {});
  std::uint64_t stored = 0;
  if (!in || text.size() < sizeof(stored))
    refuse(path, "the checkpoint cannot be read");
  const auto all = std::as_bytes(std::span(text));
  const auto payload = all.first(all.size() - sizeof(stored));
  std::memcpy(&stored, payload.data() + payload.size(), sizeof(stored));
  if (checksum(first_checksum, payload) != stored)
    refuse(path, "the checkpoint is damaged");
  Archive archive({payload.begin(), payload.end()}, path.string());
  Checkpoint checkpoint;
  transfer(archive, checkpoint);
  return checkpoint;
}

} // namespace kerf::output
