#include "image/spline.h"

#include <cmath>

namespace kerf::image {

namespace {

/// Replaces n values, `stride` apart, by their coefficients: a recursive filter there and back.
template <class Value>
void filter(Value* const values, const int n, const int stride) {
  const float pole = std::sqrt(3.0f) - 2;
  const auto at = [&](const int i) -> Value& { return values[static_cast<std::ptrdiff_t>(i) * stride]; };
  constexpr int far = 16; // pole^16 is less than a float's round-off
  Value sum = Value::Zero();
  float power = 1;
  for (int k = 0; k < far; ++k, power *= pole) {
    const int period = 2 * n - 2, place = k % period;
    sum += power * at(place < n ? place : period - place);
  }
  at(0) = sum;
  for (int i = 1; i < n; ++i)
    at(i) += pole * at(i - 1);
  at(n - 1) = pole / (pole * pole - 1) * (at(n - 1) + pole * at(n - 2));
  for (int i = n - 2; i >= 0; --i)
    at(i) = pole * (at(i + 1) - at(i));
  for (int i = 0; i < n; ++i)
    at(i) *= 6;
}

} // namespace

template <class Value>
Raster<Value> spline_coefficients(const Raster<Value>& raster) {
  Raster<Value> result = raster;
  for (int r = 0; r < result.height; ++r)
    filter(&result(0, r), result.width, 1);
  for (int c = 0; c < result.width; ++c)
    filter(&result(c, 0), result.height, result.width);
  return result;
}

template Raster<Rgb> spline_coefficients(const Raster<Rgb>& raster);
template Raster<Eigen::Array4f> spline_coefficients(const Raster<Eigen::Array4f>& raster);

} // namespace kerf::image
