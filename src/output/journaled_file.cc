#include "output/journaled_file.h"

#include "base/error.h"
#include "output/checksum.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace kerf::output {
namespace {

constexpr std::uint64_t magic = 0x6b6572666a726e6c;

/// The last bytes of a file with a journal.
struct Trailer {
  std::uint64_t magic = 0;
  std::uint64_t size = 0;  ///< of the file after the commit [bytes]
  std::uint64_t begin = 0; ///< of the journal, at `size` or later [bytes]
  std::uint64_t n_pages = 0;
  std::uint64_t checksum = 0;
};

std::uint64_t checksum(const Trailer& t, const std::span<const std::byte> journal) {
  const std::array<std::uint64_t, 4> head = {t.magic, t.size, t.begin, t.n_pages};
  return output::checksum(output::checksum(first_checksum, std::as_bytes(std::span(head))), journal);
}

/// 0, or the error number.
int write_all(const int descriptor, std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const auto n = pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno != EINTR)
      return errno;
    if (n == 0)
      return ENOSPC;
    if (n > 0) {
      bytes = bytes.subspan(n);
      offset += n;
    }
  }
  return 0;
}

/// 0, or the error number. What lies behind the end of the file reads as zero.
int read_all(const int descriptor, std::uint64_t offset, std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const auto n = pread(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno != EINTR)
      return errno;
    if (n == 0) {
      std::ranges::fill(bytes, std::byte{0});
      return 0;
    }
    if (n > 0) {
      bytes = bytes.subspan(n);
      offset += n;
    }
  }
  return 0;
}

std::string error_text(const int error) { return std::generic_category().message(error); }

[[noreturn]] void throw_cannot(const std::string& what, const std::filesystem::path& path, const int error) {
  throw DataError({.file = path.string(),
                   .rule = "cannot be " + what + ": " + error_text(error),
                   .remedy = "Name a file in a folder that exists and where you may write"});
}

std::uint64_t size_of(const int descriptor) {
  struct stat status {};
  return fstat(descriptor, &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

struct Journal {
  Trailer trailer;
  std::vector<std::uint64_t> numbers;
  std::vector<std::byte> pages;
};

/// The journal at the end of a file; no pages when there is none, or not a whole one.
Journal find_journal(const int descriptor) {
  constexpr std::uint64_t entry = JournaledFile::page_size + sizeof(std::uint64_t);
  const auto end = size_of(descriptor);
  Journal journal;
  auto& trailer = journal.trailer;
  if (end < sizeof(Trailer))
    return {};
  if (read_all(descriptor, end - sizeof(Trailer), std::as_writable_bytes(std::span(&trailer, 1))) != 0)
    return {};
  const bool fits = trailer.magic == magic && trailer.n_pages > 0 && trailer.n_pages <= end / entry &&
                    trailer.begin <= end && trailer.begin + trailer.n_pages * entry + sizeof(Trailer) <= end;
  if (!fits)
    return {};

  std::vector<std::byte> bytes(trailer.n_pages * entry);
  if (read_all(descriptor, trailer.begin, bytes) != 0 || checksum(trailer, bytes) != trailer.checksum)
    return {};
  const auto n_page_bytes = trailer.n_pages * JournaledFile::page_size;
  journal.numbers.resize(trailer.n_pages);
  std::memcpy(journal.numbers.data(), bytes.data() + n_page_bytes, bytes.size() - n_page_bytes);
  bytes.resize(n_page_bytes);
  journal.pages = std::move(bytes);
  return journal;
}

/// Writes the part of a page that lies inside a file of `size` bytes: what follows may be the journal. 0, or the error.
int write_page(const int descriptor, const std::uint64_t number, const std::span<const std::byte> page,
               const std::uint64_t size) {
  const auto begin = number * JournaledFile::page_size;
  if (begin >= size)
    return 0;
  return write_all(descriptor, begin, page.first(std::min<std::uint64_t>(page.size(), size - begin)));
}

/// True when this descriptor is the file's only writer, or when the file system has no locks.
bool lock_for_writing(const int descriptor) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return fcntl(descriptor, F_OFD_SETLK, &whole) == 0 || (errno != EAGAIN && errno != EACCES);
}

/// Calls f(page number, offset in the page, offset in the bytes, length) for each page that a range touches.
template <class Function>
void for_each_page(const std::uint64_t offset, const std::size_t n, const Function& f) {
  for (std::size_t done = 0; done < n;) {
    const auto at = offset + done;
    const auto in_page = static_cast<std::size_t>(at % JournaledFile::page_size);
    const auto length = std::min(JournaledFile::page_size - in_page, n - done);
    f(at / JournaledFile::page_size, in_page, done, length);
    done += length;
  }
}

} // namespace

JournaledFile::JournaledFile(const std::filesystem::path& path, const Mode mode) : path_(path) {
  if (mode == Mode::modify)
    recover(path);
  descriptor_ = open(path.c_str(), O_RDWR | O_CLOEXEC | (mode == Mode::create ? O_CREAT : 0), 0666);
  if (descriptor_ < 0)
    throw_cannot("written", path, errno);
  const bool locked = lock_for_writing(descriptor_);
  if (!locked || (mode == Mode::create && ftruncate(descriptor_, 0) != 0)) {
    const int error = locked ? errno : ETXTBSY;
    close(descriptor_);
    throw_cannot("written", path, error);
  }
  size_ = committed_ = size_of(descriptor_);
}

JournaledFile::~JournaledFile() {
  // What no commit claimed only wastes space: failing to cut it off does no harm.
  if (size_of(descriptor_) > committed_ && ftruncate(descriptor_, static_cast<off_t>(committed_)) != 0)
    errno = 0;
  close(descriptor_);
}

void JournaledFile::read(const std::uint64_t offset, const std::span<std::byte> bytes) const {
  if (const int error = read_all(descriptor_, offset, bytes))
    throw_cannot("read", path_, error);
  for_each_page(offset, bytes.size(), [&](auto number, auto in_page, auto done, auto length) {
    if (const auto found = pages_.find(number); found != pages_.end())
      std::memcpy(&bytes[done], &found->second.bytes[in_page], length);
  });
}

JournaledFile::Page& JournaledFile::page(const std::uint64_t number) {
  const auto [entry, is_new] = pages_.try_emplace(number);
  if (is_new) {
    entry->second.bytes.resize(page_size);
    if (const int error = read_all(descriptor_, number * page_size, entry->second.bytes))
      throw_cannot("read", path_, error);
  }
  return entry->second;
}

void JournaledFile::write_to_pages(const std::uint64_t offset, const std::span<const std::byte> bytes) {
  for_each_page(offset, bytes.size(), [&](auto number, auto in_page, auto done, auto length) {
    auto& p = page(number);
    p.changed = p.changed || std::memcmp(&p.bytes[in_page], &bytes[done], length) != 0;
    std::memcpy(&p.bytes[in_page], &bytes[done], length);
  });
}

void JournaledFile::write_behind(const std::uint64_t offset, const std::span<const std::byte> bytes) {
  if (const int error = write_all(descriptor_, offset, bytes)) {
    abandon(describe(error, offset + bytes.size() - committed_));
    write_to_pages(offset, bytes);
  }
}

void JournaledFile::write(const std::uint64_t offset, const std::span<const std::byte> bytes) {
  size_ = std::max(size_, offset + bytes.size());
  const auto first_free = (committed_ + page_size - 1) / page_size * page_size; // whole pages wait, or none
  const auto below =
    abandoned() ? bytes.size() : std::min<std::uint64_t>(bytes.size(), first_free - std::min(first_free, offset));
  write_to_pages(offset, bytes.first(below));
  if (below < bytes.size())
    write_behind(offset + below, bytes.subspan(below));
}

void JournaledFile::reserve(const std::uint64_t end) {
  const auto begin = std::max(reserved_, committed_);
  if (end <= begin)
    return;
  if (const int error = posix_fallocate(descriptor_, static_cast<off_t>(begin), static_cast<off_t>(end - begin)))
    throw DataError(describe(error, end - begin));
  reserved_ = end;
}

/// Returns where the trailer stands.
std::uint64_t JournaledFile::write_journal(const std::uint64_t size) {
  std::vector<std::byte> bytes;
  std::vector<std::uint64_t> numbers;
  for (const auto& [number, page] : pages_)
    if (page.changed) {
      numbers.push_back(number);
      bytes.insert(bytes.end(), page.bytes.begin(), page.bytes.end());
    }
  const auto raw_numbers = std::as_bytes(std::span(numbers));
  bytes.insert(bytes.end(), raw_numbers.begin(), raw_numbers.end());
  Trailer trailer = {magic, size, std::max(size, size_), numbers.size(), 0};
  trailer.checksum = checksum(trailer, bytes);

  reserve(trailer.begin + bytes.size() + sizeof(Trailer));
  const auto place = std::max(reserved_, size_of(descriptor_)) - sizeof(Trailer);
  int error = write_all(descriptor_, trailer.begin, bytes);
  if (error == 0)
    error = write_all(descriptor_, place, std::as_bytes(std::span(&trailer, 1)));
  if (error != 0)
    throw DataError(describe(error, bytes.size()));
  return place;
}

void JournaledFile::commit(const std::uint64_t size) {
  if (abandoned())
    throw DataError(failure_);
  if (pages_.empty() && size == committed_)
    return;
  std::uint64_t trailer = 0;
  try {
    trailer = write_journal(size);
  } catch (const DataError& error) {
    abandon(error.what());
    throw;
  }
  int error = 0;
  for (const auto& [number, page] : pages_)
    if (error == 0 && page.changed)
      error = write_page(descriptor_, number, page.bytes, size);
  constexpr std::array<std::byte, sizeof(Trailer)> struck_out = {};
  if (error == 0)
    error = write_all(descriptor_, trailer, struck_out);
  if (error != 0)
    throw_cannot("written", path_, error);
  pages_.clear();
  committed_ = size_ = size;
}

void JournaledFile::abandon(const std::string& reason) {
  if (!abandoned())
    failure_ = reason;
}

std::string JournaledFile::describe(const int error, const std::uint64_t wanted) const {
  std::error_code ignored;
  const auto space = std::filesystem::space(path_, ignored);
  const auto free = ignored ? std::string("an unknown number of") : std::to_string(space.available);
  return to_string({.file = path_.string(),
                    .rule = "cannot take " + std::to_string(wanted) + " bytes more (" + error_text(error) + "); " +
                            free + " bytes are free; what was written before is kept",
                    .remedy = "Free disk space or raise the quota, or write to another disk"});
}

void recover(const std::filesystem::path& path) {
  const int reading = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (reading < 0)
    throw DataError({.file = path.string(),
                     .rule = "cannot be opened: " + error_text(errno),
                     .remedy = "Name a file that exists and that you may read"});
  const bool cut_short = !find_journal(reading).pages.empty();
  close(reading);
  if (!cut_short)
    return;

  const int descriptor = open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0)
    throw_cannot("repaired after a kill", path, errno);
  // Looked for again under the lock: while the writer lives, a journal is its own affair.
  const auto journal = lock_for_writing(descriptor) ? find_journal(descriptor) : Journal{};
  int error = 0;
  for (std::size_t i = 0; i < journal.numbers.size() && error == 0; ++i)
    error = write_page(descriptor, journal.numbers[i],
                       std::span(journal.pages).subspan(i * JournaledFile::page_size, JournaledFile::page_size),
                       journal.trailer.size);
  if (error == 0 && !journal.numbers.empty() && ftruncate(descriptor, static_cast<off_t>(journal.trailer.size)) != 0)
    error = errno;
  close(descriptor);
  if (error != 0)
    throw_cannot("repaired after a kill", path, error);
}

} // namespace kerf::output
