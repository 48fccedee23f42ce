#include "warp/energy.h"

#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace kerf::warp {

namespace {

using Eigen::VectorXd;

/// Value and slope between pixels.
struct Sampled {
  double value, dx, dy;
};

Sampled sample_with_slope(const image::Grey& grey, const double x, const double y) {
  const float fx = static_cast<float>(x), fy = static_cast<float>(y);
  const image::Footing f = image::footing(grey.width, grey.height, fx, fy);
  const float* const p = &grey.values[grey.index(f.column, f.row)];
  const float* const q = p + grey.width;
  const double top = p[0] + f.right * (p[1] - p[0]), bottom = q[0] + f.right * (q[1] - q[0]);
  const bool in_x = fx > 0 && fx < static_cast<float>(grey.width - 1);
  const bool in_y = fy > 0 && fy < static_cast<float>(grey.height - 1);
  return {top + f.down * (bottom - top), in_x ? (1 - f.down) * (p[1] - p[0]) + f.down * (q[1] - q[0]) : 0.0,
          in_y ? bottom - top : 0.0};
}

Vec2 node(const VectorXd& x, const int i) { return x.segment<2>(2 * i); }

} // namespace

Mat2 Energy::inverse_of(const Mat2& m) { return m.inverse(); }

VectorXd to_unknowns(const LatticeMap& map) {
  VectorXd x(2 * map.nodes.size());
  for (std::size_t i = 0; i < map.nodes.size(); ++i)
    x.segment<2>(2 * i) = map.nodes[i];
  return x;
}

void from_unknowns(const VectorXd& x, LatticeMap& map) {
  for (std::size_t i = 0; i < map.nodes.size(); ++i)
    map.nodes[i] = x.segment<2>(2 * i);
}

Mat2 nearest_rotation(const Mat2& m) {
  const Vec2 direction(m(0, 0) + m(1, 1), m(1, 0) - m(0, 1));
  const double length = direction.norm();
  if (!(length > 0))
    return Mat2::Identity();
  Mat2 r;
  r << direction[0], -direction[1], direction[1], direction[0];
  return r / length;
}

Energy::Energy(const LatticeMap& rest, const FeatureLevel* features, std::vector<Pin> pins,
               const EnergyOptions& options)
  : rest_(rest), features_(features), pins_(std::move(pins)), options_(options) {
  cells_ = stiffness_of_cells();
  for (const Pin& pin : pins_)
    pin_feet_.push_back(foot(pin.from));
  if (!features_)
    return;
  const image::Grey& grey = features_->a.front();
  const Vec2 pixel = (rest.upper - rest.lower).cwiseQuotient(Vec2(grey.width - 1, grey.height - 1));
  for (int r = 0; r < grey.height; ++r)
    for (int c = 0; c < grey.width; ++c)
      pixels_.push_back(foot(rest.lower + pixel.cwiseProduct(Vec2(c, r))));
}

Energy::Foot Energy::foot(const Vec2& p) const {
  const Vec2 q = (p - rest_.lower).cwiseQuotient(rest_.spacing());
  const int c = std::clamp(static_cast<int>(std::floor(q[0])), 0, rest_.n_columns - 2);
  const int r = std::clamp(static_cast<int>(std::floor(q[1])), 0, rest_.n_rows - 2);
  const double u = q[0] - c, v = q[1] - r;
  const int first = r * rest_.n_columns + c;
  return {{first, first + 1, first + rest_.n_columns, first + rest_.n_columns + 1},
          {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v}};
}

std::vector<double> Energy::stiffness_of_cells() const {
  const int nx = rest_.n_columns - 1, ny = rest_.n_rows - 1;
  std::vector<double> weights(nx * ny, options_.section ? options_.outside : 1.0);
  if (!options_.section)
    return weights;
  const image::Grey& section = *options_.section;
  for (int r = 0; r < section.height; ++r)
    for (int c = 0; c < section.width; ++c)
      if (section(c, r) > 0.5f) {
        // A pixel on a line between cells counts for both.
        for (const int row : {r * ny / (section.height - 1), std::max(0, r * ny - 1) / (section.height - 1)})
          for (const int column : {c * nx / (section.width - 1), std::max(0, c * nx - 1) / (section.width - 1)})
            weights[std::min(ny - 1, row) * nx + std::min(nx - 1, column)] = 1;
      }
  return weights;
}

double Energy::operator()(const VectorXd& x, VectorXd& gradient) const {
  gradient.setZero(x.size());
  double value = add_triangles(x, gradient);
  if (!std::isfinite(value))
    return value;
  if (features_)
    value += add_features(x, gradient);
  if (!pins_.empty())
    value += add_pins(x, gradient);
  hold_border(gradient);
  return value;
}

double Energy::add_features(const VectorXd& x, VectorXd& gradient) const {
  const int width = features_->a.front().width, height = features_->a.front().height;
  const Vec2 to_pixels = Vec2(width - 1, height - 1).cwiseQuotient(rest_.upper - rest_.lower);
  const double share = 1.0 / static_cast<double>(pixels_.size());
  double sum = 0;
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const Foot& at = pixels_[i];
    Vec2 p = Vec2::Zero();
    for (int k = 0; k < 4; ++k)
      p += at.shares[k] * node(x, at.nodes[k]);
    p = (p - rest_.lower).cwiseProduct(to_pixels);
    Vec2 slope = Vec2::Zero();
    for (std::size_t channel = 0; channel < features_->a.size(); ++channel) {
      const Sampled b = sample_with_slope(features_->b[channel], p[0], p[1]);
      const double difference = b.value - features_->a[channel].values[i];
      sum += difference * difference;
      slope += 2 * difference * Vec2(b.dx, b.dy);
    }
    slope = share * slope.cwiseProduct(to_pixels);
    for (int k = 0; k < 4; ++k)
      gradient.segment<2>(2 * at.nodes[k]) += at.shares[k] * slope;
  }
  return share * sum;
}

/// One triangle's cost; `derivative` is by its gradient j.
double Energy::triangle(const Mat2& j, const double share, const double stiffness, Mat2& derivative) const {
  const double d = j.determinant();
  if (!(d > 0))
    return std::numeric_limits<double>::infinity();
  const Mat2 away = j - (options_.regularity == Regularity::rigid ? nearest_rotation(j) : Mat2(Mat2::Identity()));
  double value = share * stiffness * away.squaredNorm();
  derivative = 2 * share * stiffness * away;
  if (d < 0.5) {
    const double weight = share * options_.barrier, gap = d - 0.5, logarithm = std::log(2 * d);
    value -= weight * gap * gap * logarithm;
    Mat2 cofactor;
    cofactor << j(1, 1), -j(1, 0), -j(0, 1), j(0, 0);
    derivative -= weight * (2 * gap * logarithm + gap * gap / d) * cofactor;
  }
  return value;
}

double Energy::add_triangles(const VectorXd& x, VectorXd& gradient) const {
  const Vec2 h = rest_.spacing();
  const double share = 0.25 / ((rest_.n_columns - 1) * (rest_.n_rows - 1));
  double sum = 0;
  for (int r = 0; r + 1 < rest_.n_rows; ++r)
    for (int c = 0; c + 1 < rest_.n_columns; ++c) {
      const int first = r * rest_.n_columns + c;
      const double stiffness = options_.stiffness * cells_[r * (rest_.n_columns - 1) + c];
      for (const int dr : {0, 1})
        for (const int dc : {0, 1}) {
          const int left = first + dr * rest_.n_columns, top = first + dc;
          Mat2 j, derivative;
          j.col(0) = (node(x, left + 1) - node(x, left)) / h[0];
          j.col(1) = (node(x, top + rest_.n_columns) - node(x, top)) / h[1];
          const double value = triangle(global_inverse_ * j, share, stiffness, derivative);
          if (!std::isfinite(value))
            return value;
          sum += value;
          const Mat2 by_nodes = global_inverse_.transpose() * derivative;
          gradient.segment<2>(2 * (left + 1)) += by_nodes.col(0) / h[0];
          gradient.segment<2>(2 * left) -= by_nodes.col(0) / h[0];
          gradient.segment<2>(2 * (top + rest_.n_columns)) += by_nodes.col(1) / h[1];
          gradient.segment<2>(2 * top) -= by_nodes.col(1) / h[1];
        }
    }
  return sum;
}

double Energy::add_pins(const VectorXd& x, VectorXd& gradient) const {
  const double weight =
    options_.pin_weight / (static_cast<double>(pins_.size()) * options_.pin_unit * options_.pin_unit);
  double sum = 0;
  for (std::size_t i = 0; i < pins_.size(); ++i) {
    Vec2 away = -pins_[i].to;
    for (int k = 0; k < 4; ++k)
      away += pin_feet_[i].shares[k] * node(x, pin_feet_[i].nodes[k]);
    sum += away.squaredNorm();
    for (int k = 0; k < 4; ++k)
      gradient.segment<2>(2 * pin_feet_[i].nodes[k]) += 2 * weight * pin_feet_[i].shares[k] * away;
  }
  return weight * sum;
}

void Energy::hold_border(VectorXd& gradient) const {
  if (options_.border == Border::free)
    return;
  for (int r = 0; r < rest_.n_rows; ++r)
    for (const int c : {0, rest_.n_columns - 1})
      gradient[2 * (r * rest_.n_columns + c)] = 0;
  for (int c = 0; c < rest_.n_columns; ++c)
    for (const int r : {0, rest_.n_rows - 1})
      gradient[2 * (r * rest_.n_columns + c) + 1] = 0;
}

} // namespace kerf::warp
