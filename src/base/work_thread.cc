#include "base/work_thread.h"

#include <ctime>
#include <pthread.h>
#include <utility>

namespace kerf {

WorkThread::WorkThread() : thread_([this](const std::stop_token& stop) { work(stop); }) {}

WorkThread::~WorkThread() {
  try {
    wait();
  } catch (...) { // whoever wants to know has waited before
  }
}

void WorkThread::give(std::function<void()> work) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return !next_; });
  throw_failure();
  next_ = std::move(work);
  changed_.notify_all();
}

void WorkThread::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return !next_ && !works_; });
  throw_failure();
}

double WorkThread::cpu_seconds() const {
  clockid_t clock{};
  timespec time{};
  if (pthread_getcpuclockid(const_cast<std::jthread&>(thread_).native_handle(), &clock) != 0 ||
      clock_gettime(clock, &time) != 0)
    return 0;
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

void WorkThread::throw_failure() {
  if (failure_)
    std::rethrow_exception(std::exchange(failure_, nullptr));
}

void WorkThread::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return bool(next_); })) {
    std::function<void()> piece = std::exchange(next_, nullptr);
    works_ = true;
    changed_.notify_all();
    if (!failure_) {
      lock.unlock();
      std::exception_ptr failure;
      try {
        piece();
      } catch (...) {
        failure = std::current_exception();
      }
      piece = nullptr; // what it holds goes before it counts as done
      lock.lock();
      failure_ = failure;
    }
    works_ = false;
    changed_.notify_all();
  }
}

} // namespace kerf
