#pragma once

/// An OpenGL context without a window: OSMesa, core profile 3.3 or later, drawn by the processor (llvmpipe).
/// Every other object of this room belongs to the context that was current when it was made, and needs it current
/// when it is used or destroyed. A context is current for one thread at a time.

#include <memory>
#include <string>

namespace kerf::gl {

struct Version {
  int major = 0, minor = 0;
};

class Context {
 public:
  /// Makes a context and makes it current; throws DataError if Mesa cannot give one.
  Context();
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  /// Directs the GL calls of this thread to this context; throws DataError if Mesa refuses.
  void make_current() const;
  /// Directs the GL calls of this thread to none, so that another thread may have this context.
  void release() const;

  /// Clips what is drawn from now on where gl_ClipDistance[i] < 0, i < n, n <= 8.
  void clip(int n) const;

  Version version() const;

  /// Who draws: "llvmpipe (LLVM 15.0.6, 256 bits)".
  std::string device() const;

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

} // namespace kerf::gl
