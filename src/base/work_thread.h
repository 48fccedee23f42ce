#pragma once

/// Work that is done in a thread of its own beside its giver's, one piece after the other: files that are written while
/// a run goes on.

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace kerf {

class WorkThread {
 public:
  WorkThread();
  /// Waits for what was given; what fails then is told to nobody.
  ~WorkThread();
  WorkThread(const WorkThread&) = delete;
  WorkThread& operator=(const WorkThread&) = delete;

  /// At most two pieces are kept, one of which is being done: waits until there is room. Throws what an earlier one has
  /// thrown, once; what was given after that one and before is not done.
  void give(std::function<void()> work);
  /// Waits until all is done; throws likewise.
  void wait();
  /// CPU time that its thread has taken until now [s].
  double cpu_seconds() const;

 private:
  void work(const std::stop_token& stop);
  void throw_failure();

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::function<void()> next_; ///< to be done; empty: nothing
  bool works_ = false;         ///< on one that is `next_` no more
  std::exception_ptr failure_; ///< nothing is done until it is told
  std::jthread thread_; ///< last: it uses all the others
};

} // namespace kerf
