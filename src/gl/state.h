#pragma once

/// What OpenGL keeps between calls, set for as long as an object lives.

namespace kerf::gl {

/// Pixels with lower <= x, y < upper; OpenGL's rows run upwards.
struct Rectangle {
  int left = 0, lower = 0, right = 0, upper = 0;

  bool empty() const { return left >= right || lower >= upper; }
  Rectangle times(int n) const { return {n * left, n * lower, n * right, n * upper}; }
};

/// Nothing else is drawn or cleared.
class Within {
 public:
  explicit Within(const Rectangle& rectangle);
  ~Within();
  Within(const Within&) = delete;
  Within& operator=(const Within&) = delete;
};

/// Depths are drawn, colours are not.
class DepthsAlone {
 public:
  DepthsAlone();
  ~DepthsAlone();
  DepthsAlone(const DepthsAlone&) = delete;
  DepthsAlone& operator=(const DepthsAlone&) = delete;
};

/// What has the depth that was drawn already is drawn too.
class EqualDepthsPass {
 public:
  EqualDepthsPass();
  ~EqualDepthsPass();
  EqualDepthsPass(const EqualDepthsPass&) = delete;
  EqualDepthsPass& operator=(const EqualDepthsPass&) = delete;
};

} // namespace kerf::gl
