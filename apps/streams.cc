#include "streams.h"

#include "base/error.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

namespace kerf::apps {

namespace {

bool nobody_reads(const int descriptor) {
  pollfd stream{descriptor, POLLOUT, 0};
  return poll(&stream, 1, 0) == 1 && (stream.revents & POLLERR) != 0;
}

} // namespace

void make_streams_safe() {
  std::signal(SIGPIPE, SIG_IGN);
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(descriptor, F_GETFD) == -1 && errno == EBADF)
      open("/dev/null", O_RDWR); // takes the lowest number that is free: this one
}

void finish_stdout() {
  errno = 0;
  const bool is_written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (is_written || nobody_reads(STDOUT_FILENO))
    return;
  if (errno == 0 && std::fputc('\n', stdout) != EOF) // an earlier write has failed: one more says why
    std::fflush(stdout);
  throw DataError(
    Complaint{.file = "stdout",
              .rule = "has not taken all that was said: " + std::generic_category().message(errno != 0 ? errno : EIO),
              .remedy = "Free disk space, or send it elsewhere; files of results are whole"});
}

} // namespace kerf::apps
