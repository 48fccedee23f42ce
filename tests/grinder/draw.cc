#include "tests/grinder/draw.h"

#include <Eigen/Geometry>

#include <cmath>
#include <cstdint>

namespace kerf::grinder {

namespace {

/// FNV-1a: std::hash may be another in another library.
std::uint32_t digest(const std::string& name) {
  std::uint32_t sum = 2166136261u;
  for (const char c : name)
    sum = (sum ^ static_cast<unsigned char>(c)) * 16777619u;
  return sum;
}

std::mt19937 seeded(const std::string& name, const unsigned seed) {
  std::seed_seq sequence{digest(name), seed};
  return std::mt19937(sequence);
}

} // namespace

Chance::Chance(const std::string& name, const unsigned seed) : random_(seeded(name, seed)) {}

double Chance::between(const double low, const double high) {
  return std::uniform_real_distribution<double>(low, high)(random_);
}

double Chance::log_between(const double low, const double high) {
  return std::exp(between(std::log(low), std::log(high)));
}

int Chance::number(const int least, const int most) { return std::uniform_int_distribution<int>(least, most)(random_); }

bool Chance::happens(const double probability) { return between(0, 1) < probability; }

Vec3 Chance::direction() {
  std::normal_distribution<double> normal;
  Vec3 d;
  for (int axis = 0; axis < 3; ++axis)
    d[axis] = normal(random_);
  return d.normalized();
}

Vec3 Chance::across(const Vec3& direction) { return direction.cross(this->direction()).normalized(); }

std::string text(const Vec3& v) { return to_text(v[0]) + ", " + to_text(v[1]) + ", " + to_text(v[2]); }

std::string text(const Points& points) {
  std::string all;
  for (const Vec3& p : points)
    all += (all.empty() ? "" : "; ") + text(p);
  return all;
}

std::string text(const std::vector<double>& numbers) {
  std::string all;
  for (const double number : numbers)
    all += (all.empty() ? "" : ", ") + to_text(number);
  return all;
}

} // namespace kerf::grinder
