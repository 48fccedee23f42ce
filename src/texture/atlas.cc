#include "texture/atlas.h"

#include "base/parallel.h"
#include "image/formats.h"
#include "texture/in_plane.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::texture {

/// What painting takes memory for, which is kept from group to group.
struct Brush {
  InPlane plane;
  SamplePoints points = {};
  std::vector<std::size_t> triangles = {};
  std::vector<Corners> corners = {};
  std::vector<Eigen::Array4f> colours = {};
};

namespace {

/// By how much the relief rises along whole edges.
class Slope {
 public:
  Slope(const InPlane& inside, const Vec3& edge, const double relief, const double pixel)
    : inside_(inside),
      along_(inside.along(edge.stableNormalized())),
      scale_(static_cast<float>(relief * edge.norm() / (2 * pixel))) {}
  /// At a point of the lattice.
  float at(const Eigen::Vector2f& q) const { return scale_ * inside_.rise(q, along_); }

 private:
  const InPlane& inside_;
  Eigen::Vector2f along_;
  float scale_;
};

std::array<std::uint8_t, 3> to_bytes(const Eigen::Array4f& colour) {
  return {image::to_byte(colour[0]), image::to_byte(colour[1]), image::to_byte(colour[2])};
}

/// The side of the squares that a triangle is halves of, area for area; of slivers, those that are as long across.
/// Parts of a triangle with n of them a side are halves of squares n times smaller. The same bits for any order of
/// corners.
double square_side(const Corners& corners) {
  double longest = 0, twice_area = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 next = corners[(i + 1) % 3] - corners[i], last = corners[(i + 2) % 3] - corners[i];
    longest = std::max(longest, next.norm());
    twice_area = std::max(twice_area, next.cross(last).norm());
  }
  return std::max(std::sqrt(twice_area), longest / std::sqrt(2));
}

/// Calls f(p) for each sample of a triangle with n parts a side, in their order.
template <class Function>
void for_each_point(const Corners& corners, const int n, const Function& f) {
  const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
  for_each_sample(n, [&](const int i, const int j) { f(Vec3(corners[0] + double(i) / n * u + double(j) / n * v)); });
}

double parts_for(const double square_side, const double resolution) {
  constexpr double rounding = 1e-9;
  return std::max(1.0, std::ceil(square_side / resolution - rounding));
}

/// Colours of places in the rest frame [m], eight at a time.
void find_colours(const Interior& inside, const std::vector<Vec3>& places, std::vector<Eigen::Array4f>& colours) {
  colours.resize(places.size());
  std::array<Blend, n_lanes> blends;
  std::array<Blend*, n_lanes> each;
  for (std::size_t l = 0; l < n_lanes; ++l)
    each[l] = &blends[l];
  for (std::size_t first = 0; first < places.size(); first += n_lanes) {
    const std::size_t n = std::min<std::size_t>(n_lanes, places.size() - first);
    inside.blend(std::span(places).subspan(first, n), inside.options().blending, each);
    for (std::size_t l = 0; l < n; ++l)
      colours[first + l] = inside.colour(blends[l]);
  }
}

} // namespace

void Atlas::fill_skin(const std::size_t t, const Skin& skin) {
  std::uint32_t sample = first_[t];
  for_each_point(filled_[t], parts_[t], [&](const Vec3& p) { colours_[sample++] = to_bytes(skin.colour(p)); });
}

/// Paints groups of triangles; what they have in common is found once.
void Atlas::fill_groups(const std::span<const FlatGroup> groups, const Paint& paint, Brush& brush) {
  brush.triangles.clear();
  for (const FlatGroup& group : groups)
    brush.triangles.insert(brush.triangles.end(), group.begin(), group.end());
  brush.points.collect(brush.triangles, filled_, parts_);
  find_colours(*paint.inside, brush.points.places(), brush.colours);
  const double pixel = paint.inside->pixel();
  const std::uint32_t* number = brush.points.numbers().data();
  for (const FlatGroup& group : groups) {
    brush.corners.clear();
    for (const std::size_t t : group)
      brush.corners.push_back(filled_[t]);
    brush.plane.lay(brush.corners);
    for (const std::size_t t : group) {
      const Slope first(brush.plane, filled_[t][1] - filled_[t][0], paint.relief, pixel);
      const Slope second(brush.plane, filled_[t][2] - filled_[t][0], paint.relief, pixel);
      const std::size_t end = first_[t] + n_samples(parts_[t]);
      for (std::size_t sample = first_[t]; sample < end; ++sample, ++number) {
        const Eigen::Vector2f q = brush.plane.on_lattice(brush.points.places()[*number]);
        colours_[sample] = to_bytes((brush.colours[*number] + brush.plane.change(q)).max(0.0f).min(1.0f));
        if (paint.relief != 0)
          slopes_[sample] = {first.at(q), second.at(q)};
      }
    }
  }
}

double n_samples_of(const double area, const double resolution, const double cube_edge) {
  const double side = 0.5 * cube_edge, n = parts_for(side, resolution);
  return area / (side * side) * (n + 1) * (n + 2);
}

std::size_t Atlas::n_coarse() const {
  std::size_t n = 0;
  for (std::size_t t = 0; t < parts_.size(); ++t)
    n += parts_[t] == max_parts && square_side(filled_[t]) > max_parts * resolution_ ? 1 : 0;
  return n;
}

/// A triangle has no samples any more, if it had some.
void Atlas::give_back(const std::size_t t) {
  if (first_[t] == none)
    return;
  places_.give_back(first_[t], n_samples(parts_[t]));
  first_[t] = none;
  parts_[t] = 0;
  fill_of_[t] = 0;
}

/// Samples for what is new, which is returned; not yet their colours. A triangle with as many as before keeps its places;
/// all others that had some give theirs back first.
std::vector<std::size_t> Atlas::lay_out(const SurfaceView& surface, const Paint& paint) {
  const std::size_t n = surface.triangles.size();
  first_.resize(n, none);
  parts_.resize(n, 0);
  fill_of_.resize(n, 0);
  filled_.resize(n);
  labels_.resize(n, 0);
  std::vector<std::size_t> fresh;
  for (std::size_t t = 0; t < n; ++t) {
    if (surface.labels[t] == 0 && !paint.skin) {
      give_back(t); // it may have been revealed before: later cuts can give a triangle at a rim to the skin
      continue;
    }
    const Triangle& v = surface.triangles[t];
    const Corners& before = filled_[t];
    if (first_[t] != none && labels_[t] == surface.labels[t] && before[0] == surface.rest[v[0]] &&
        before[1] == surface.rest[v[1]] && before[2] == surface.rest[v[2]])
      continue;
    const Corners corners = {surface.rest[v[0]], surface.rest[v[1]], surface.rest[v[2]]};
    const auto n_parts =
      static_cast<std::uint16_t>(std::min(parts_for(square_side(corners), resolution_), double(max_parts)));
    if (parts_[t] != n_parts)
      give_back(t);
    parts_[t] = n_parts;
    filled_[t] = corners;
    labels_[t] = surface.labels[t];
    fresh.push_back(t);
  }
  n_fills_ += fresh.empty() ? 0 : 1;
  for (const std::size_t t : fresh) {
    if (first_[t] == none)
      first_[t] = static_cast<std::uint32_t>(places_.take(n_samples(parts_[t])));
    fill_of_[t] = n_fills_;
  }
  colours_.resize(places_.end());
  if (paint.relief != 0)
    slopes_.resize(places_.end(), {0, 0});
  return fresh;
}

/// Where none sees its surroundings, any do.
std::vector<FlatGroup> Atlas::groups_of(const std::vector<std::size_t>& revealed, const Paint& paint) const {
  if (paint.detail || paint.relief != 0)
    return flat_groups(revealed, filled_, paint.inside->charts().front().body_axes, paint.inside->origin(),
                       paint.inside->pixel());
  constexpr std::ptrdiff_t size = 16;
  std::vector<FlatGroup> groups;
  for (auto t = revealed.begin(); t != revealed.end();) {
    const auto end = revealed.end() - t > size ? t + size : revealed.end();
    groups.emplace_back(t, end);
    t = end;
  }
  return groups;
}

/// Parts groups so that each part has not many more than `most` samples.
std::vector<std::size_t> Atlas::parts_of(const std::vector<FlatGroup>& groups, const std::size_t most) const {
  std::vector<std::size_t> ends;
  std::size_t n = 0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (const std::size_t t : groups[i])
      n += n_samples(parts_[t]);
    if (n >= most || i + 1 == groups.size()) {
      ends.push_back(i + 1);
      n = 0;
    }
  }
  return ends;
}

/// What rises along the edges from the first's first corner rises along the twin's as their differences do.
void Atlas::copy(const Twin& twin) {
  const int n = parts_[twin.number];
  const auto& [a, b, c] = twin.corner;
  std::size_t sample = first_[twin.number];
  for_each_sample(n, [&](const int i, const int j) {
    const std::size_t from = first_[twin.first] + sample_of_first(twin, n, i, j);
    colours_[sample] = colours_[from];
    if (!slopes_.empty()) {
      const std::array<float, 3> rise = {0, slopes_[from][0], slopes_[from][1]};
      slopes_[sample] = {rise[b] - rise[a], rise[c] - rise[a]};
    }
    ++sample;
  });
}

std::size_t Atlas::fill(const SurfaceView& surface, const Paint& paint) {
  const std::vector<std::size_t> fresh = lay_out(surface, paint);
  const Sides sides = find_sides(fresh, filled_, labels_);
  std::vector<std::size_t> skin, revealed;
  for (const std::size_t t : sides.painted)
    (labels_[t] == 0 ? skin : revealed).push_back(t);
  const std::vector<FlatGroup> groups = groups_of(revealed, paint);
  parallel_for(skin.size(), [&](const std::size_t i) { fill_skin(skin[i], *paint.skin); });
  constexpr std::size_t most = 4096; // what painting notes of them, at most 50 bytes each, stays in a core's cache
  const std::vector<std::size_t> ends = parts_of(groups, most);
  parallel_ranges(ends.size(), 2, [&](const std::size_t begin, const std::size_t end) {
    Brush brush{
      .plane = {*paint.inside, paint.detail, paint.relief != 0 ? InPlane::Relief::wanted : InPlane::Relief::none}};
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t first = i > 0 ? ends[i - 1] : 0;
      fill_groups(std::span(groups).subspan(first, ends[i] - first), paint, brush);
    }
  });
  parallel_for(sides.twins.size(), [&](const std::size_t i) { copy(sides.twins[i]); });
  return fresh.size();
}

} // namespace kerf::texture
