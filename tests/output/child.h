#pragma once

/// A child process that works until it is done or killed, and reports numbers to its parent.

#include <sys/wait.h>
#include <unistd.h>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <thread>

namespace kerf::output {

/// The child's end.
class Report {
 public:
  explicit Report(const int descriptor) : descriptor_(descriptor) {}
  void send(const std::uint32_t number) const {
    if (write(descriptor_, &number, sizeof number) != sizeof number)
      throw std::runtime_error("the parent does not listen");
  }

 private:
  int descriptor_;
};

class Child {
 public:
  explicit Child(const std::function<void(Report&)>& work) {
    int ends[2];
    if (pipe(ends) != 0)
      throw std::runtime_error("no pipe");
    id_ = fork();
    if (id_ < 0)
      throw std::runtime_error("no fork");
    if (id_ == 0) {
      close(ends[0]);
      _exit(run(work, ends[1]));
    }
    close(ends[1]);
    descriptor_ = ends[0];
  }
  ~Child() {
    if (id_ > 0)
      kill_after(std::chrono::microseconds(0));
    close(descriptor_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void kill_after(const std::chrono::microseconds wait) {
    std::this_thread::sleep_for(wait);
    kill(id_, SIGKILL);
    exit_code();
  }

  /// Waits for the end; -1 when it was killed, 99 when its work threw.
  int exit_code() {
    int status = 0;
    waitpid(id_, &status, 0);
    id_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  /// The next number, waiting for it; 0 when there are no more.
  std::uint32_t receive() const {
    std::uint32_t number = 0;
    return read(descriptor_, &number, sizeof number) == sizeof number ? number : 0;
  }

  /// The last number of a child that has ended; 0 when there is none.
  std::uint32_t last() const {
    std::uint32_t last = 0;
    while (const auto number = receive())
      last = number;
    return last;
  }

 private:
  static int run(const std::function<void(Report&)>& work, const int descriptor) {
    try {
      Report report(descriptor);
      work(report);
      return 0;
    } catch (...) {
      return 99;
    }
  }

  pid_t id_ = -1;
  int descriptor_ = -1;
};

} // namespace kerf::output
