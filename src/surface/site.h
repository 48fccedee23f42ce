#pragma once

/// What the placement of a vertex asks of its face or cell: the planes of the cuts in it, by who made them; and where
/// two cut lines in a face are joined.

#include "surface/view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::surface {

using Labels = Few<grid::CutLabel, 60>;

inline Planes planes_of(const grid::CutLabel label, const Planes& planes, const Labels& labels) {
  Planes of_label;
  for (int i = 0; i < planes.size(); ++i)
    if (labels[i] == label)
      of_label.push_back(planes[i]);
  return of_label;
}

/// Calls f(label, its planes) for each label, in the order of their first planes.
template <class Function>
void for_each_label(const Planes& planes, const Labels& labels, const Function& f) {
  for (int i = 0; i < labels.size(); ++i)
    if (std::find(labels.begin(), labels.begin() + i, labels[i]) == labels.begin() + i)
      f(labels[i], planes_of(labels[i], planes, labels));
}

/// A face or a cell, with the planes of its cut edges sorted by what they ask of its vertex.
struct Site {
  Site(const View& of, const Directions& directions) : view(of), inside(directions) {}

  const View& view;
  Directions inside; ///< the directions within it
  Planes locked;     ///< cuts that already separate material here: the vertex stays on them
  Planes open;       ///< cuts that the vertex has yet to meet
  Labels locked_labels, open_labels;
  bool splits = false;  ///< with all cuts, material here is separated
  bool at_skin = false; ///< the skin may hold the vertex

  /// Have several blades cut it since it was placed?
  bool has_several_labels() const {
    return std::ranges::count(open_labels, open_labels[0]) < open_labels.size();
  }
  /// Does it reach along the axis?
  bool reaches(const int axis) const { return inside.projection(axis, axis) != 0; }
  void lock(const Plane& plane, const grid::CutLabel label) {
    locked.push_back(plane);
    locked_labels.push_back(label);
  }
  void open_to(const Plane& plane, const grid::CutLabel label) {
    open.push_back(plane);
    open_labels.push_back(label);
  }
};

/// Figure 2.15 (b), (c): where two cut lines in a face are joined.
class Joint {
 public:
  explicit Joint(const double sharp_angle)
    : smooth_(std::cos(sharp_angle)), turning_back_(std::cos(std::min(0.5 * std::numbers::pi + sharp_angle, limit))) {}

  /// u and v are the axes of the face.
  Vec3 operator()(const Plane& a, const Plane& b, const int u, const int v) const {
    const Vec3 middle = 0.5 * (a.point + b.point);
    const double mu = a.normal[u], mv = a.normal[v], nu = b.normal[u], nv = b.normal[v];
    const double sine = mu * nv - mv * nu, lengths2 = (mu * mu + mv * mv) * (nu * nu + nv * nv);
    if (sine * sine < 1e-12 * lengths2 || lengths2 == 0)
      return middle;
    const double da = a.normal.dot(a.point - middle), db = b.normal.dot(b.point - middle);
    Vec3 meeting = middle;
    meeting[u] += (da * nv - db * mv) / sine;
    meeting[v] += (db * mu - da * nu) / sine;
    const Vec3 arriving = meeting - a.point, leaving = b.point - meeting;
    const double turn = arriving.dot(leaving), lengths = std::sqrt(arriving.squaredNorm() * leaving.squaredNorm());
    if (turn < turning_back_ * lengths)
      return middle; // the curve would turn back: the two planes do not belong to one cut
    return turn < smooth_ * lengths ? meeting : Vec3(0.25 * (a.point + 2 * meeting + b.point));
  }

 private:
  static constexpr double limit = std::numbers::pi;
  double smooth_, turning_back_; ///< cosines of the turns where these begin
};

} // namespace kerf::surface
