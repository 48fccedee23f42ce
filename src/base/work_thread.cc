#include "base/work_thread.h"

#include <ctime>
#include <utility>

namespace kerf {

namespace {

/// Of the thread that asks [s].
double cpu_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

} // namespace

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
  const std::lock_guard lock(mutex_);
  return cpu_seconds_;
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
      const double start = cpu_time();
      try {
        piece();
      } catch (...) {
        failure = std::current_exception();
      }
      piece = nullptr; // what it holds goes before it counts as done
      const double took = cpu_time() - start;
      lock.lock();
      failure_ = failure;
      cpu_seconds_ += took;
    }
    works_ = false;
    changed_.notify_all();
  }
}

} // namespace kerf
