#pragma once

/// Draws and writes images in a thread of its own, beside the steps of a run.

#include "render/renderer.h"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace kerf::render {

class ImageThread {
 public:
  /// `renderer` has to live as long, and draws nothing else meanwhile.
  explicit ImageThread(const Renderer& renderer);
  /// Waits for what was handed over; what fails then is told to nobody.
  ~ImageThread();
  ImageThread(const ImageThread&) = delete;
  ImageThread& operator=(const ImageThread&) = delete;

  /// Hands over an image and its file. At most two are kept, one of which is being drawn: waits until there is room. Throws what an
  /// earlier one has failed with, as write_png() and Renderer::draw_batch(), once.
  void write(Batch batch, std::string path);
  /// Waits until all files are written; throws likewise.
  void wait();

 private:
  struct Order {
    Batch batch;
    std::string path;
  };

  void work(const std::stop_token& stop);
  void throw_failure();

  const Renderer& renderer_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<Order> next_;  ///< to be drawn
  bool draws_ = false;         ///< one that is `next_` no more
  std::exception_ptr failure_; ///< of an image; nothing is drawn after it
  std::jthread thread_;        ///< last: it uses all the others
};

} // namespace kerf::render
