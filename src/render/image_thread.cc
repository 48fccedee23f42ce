#include "render/image_thread.h"

#include "render/image.h"

#include <utility>

namespace kerf::render {

ImageThread::ImageThread(const Renderer& renderer)
  : renderer_(renderer), thread_([this](const std::stop_token& stop) { work(stop); }) {}

ImageThread::~ImageThread() {
  try {
    wait();
  } catch (...) { // whoever wants to know has waited before
  }
}

void ImageThread::write(Batch batch, std::string path) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return !next_; });
  throw_failure();
  next_ = {std::move(batch), std::move(path)};
  changed_.notify_all();
}

void ImageThread::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return !next_ && !draws_; });
  throw_failure();
}

void ImageThread::throw_failure() {
  if (failure_)
    std::rethrow_exception(std::exchange(failure_, nullptr));
}

void ImageThread::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return next_.has_value(); })) {
    const Order order = *std::exchange(next_, std::nullopt);
    draws_ = true;
    changed_.notify_all();
    if (!failure_) {
      lock.unlock();
      std::exception_ptr failure;
      try {
        write_png(renderer_.draw_batch(order.batch), order.path);
      } catch (...) {
        failure = std::current_exception();
      }
      lock.lock();
      failure_ = failure;
    }
    draws_ = false;
    changed_.notify_all();
  }
}

} // namespace kerf::render
