#include "texture/partition.h"

#include "base/error.h"

#include <cmath>

namespace kerf::texture {

namespace {

using image::Grey;

constexpr double least_share = 0.5;      ///< of a cell's section that an exemplar must show to divide it
constexpr double least_component = 0.02; ///< of a face's pixels
constexpr std::size_t least_pixels = 12;

bool contains(const std::vector<HalfSpace>& halves, const Vec3& p, const int but) {
  for (int i = 0; i < static_cast<int>(halves.size()); ++i)
    if (i != but && !halves[i].contains(p))
      return false;
  return true;
}

Vec3 pixel_point(const Chart& chart, const int c, const int r) {
  return chart.plane.point(chart.plane.to_local(Vec2(c, r)));
}

/// The body's section in a cell, its own half space (if it has one) left out.
Grey section_in(const Cell& cell, const Chart& chart, const int own) {
  Grey section = chart.inside;
  for (int r = 0; r < section.height; ++r)
    for (int c = 0; c < section.width; ++c)
      if (section(c, r) > 0 && !contains(cell.halves, pixel_point(chart, c, r), own))
        section(c, r) = 0;
  return section;
}

/// Whether some pixel of a section lies half a pixel away, along the section, from the planes of all half spaces but
/// its own. Planes that meet in a line leave nothing of each other's sections but that line where another one lies
/// between them; round-off may give a cell the pixels on it, which are no face.
bool has_width(const Grey& section, const Cell& cell, const Chart& chart, const int own) {
  std::vector<HalfSpace> within = cell.halves;
  for (HalfSpace& half : within)
    half.offset -= 0.5 * chart.plane.pixel() * half.normal.cross(chart.plane.normal()).norm();
  for (int r = 0; r < section.height; ++r)
    for (int c = 0; c < section.width; ++c)
      if (section(c, r) > 0 && contains(within, pixel_point(chart, c, r), own))
        return true;
  return false;
}

std::size_t count(const Grey& mask) {
  std::size_t n = 0;
  for (const float value : mask.values)
    n += value > 0.5f ? 1 : 0;
  return n;
}

std::size_t count_shown(const Grey& section, const Grey& shown) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < section.values.size(); ++i)
    n += section.values[i] > 0.5f && shown.values[i] > 0.5f ? 1 : 0;
  return n;
}

ParameterError refusal(const Exemplar& exemplar, const std::string& key, const std::string& rule,
                       const std::string& remedy) {
  return ParameterError(Complaint{.path = key, .value = "exemplar " + exemplar.name, .rule = rule, .remedy = remedy});
}

void require_own_planes(const std::vector<Exemplar>& exemplars, const std::vector<Chart>& charts) {
  for (std::size_t j = 0; j < charts.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) {
      const SectionPlane &a = charts[i].plane, &b = charts[j].plane;
      const double size = b.pixel() * std::hypot(charts[j].inside.width, charts[j].inside.height);
      const double turn = a.normal().cross(b.normal()).norm();
      const Vec3 middle = pixel_point(charts[j], charts[j].inside.width / 2, charts[j].inside.height / 2);
      if (turn < 1e-3 && std::abs(a.height(middle)) < 1e-3 * size)
        throw refusal(exemplars[j], "Origin [m]", "lies in the plane of exemplar " + exemplars[i].name,
                      "Move one of them, or leave it out");
    }
}

} // namespace

Partition::Partition(const std::vector<Exemplar>& exemplars, const std::vector<Chart>& charts,
                     const Components components) {
  require_own_planes(exemplars, charts);
  for (const Chart& chart : charts)
    planes_.push_back(chart.plane);
  cells_.resize(1);
  for (int i = 0; i < static_cast<int>(charts.size()); ++i) {
    const std::size_t n_before = cells_.size();
    divide(i, charts);
    if (cells_.size() == n_before)
      throw refusal(exemplars[i], "Origin [m]", "shows less than half of the body's section in every cell",
                    "Place it over the body, or let it be fitted (key Fit)");
  }
  add_faces(exemplars, charts, components);
}

void Partition::divide(const int exemplar, const std::vector<Chart>& charts) {
  const Chart& chart = charts[exemplar];
  const SectionPlane& plane = chart.plane;
  const int n_cells = static_cast<int>(cells_.size());
  for (int i = 0; i < n_cells; ++i) {
    const Grey section = section_in(cells_[i], chart, -1);
    const std::size_t n = count(section);
    if (n < least_pixels || !has_width(section, cells_[i], chart, -1) ||
        static_cast<double>(count_shown(section, chart.shown)) < least_share * static_cast<double>(n))
      continue;
    const int other = static_cast<int>(cells_.size());
    cells_.push_back(cells_[i]);
    const double offset = plane.normal().dot(plane.origin());
    const auto bound = [&](Cell& cell, const double side) {
      cell.halves.push_back({-side * plane.normal(), -side * offset});
      cell.exemplars.push_back(exemplar);
      cell.sides.push_back(side);
    };
    bound(cells_[i], -1);
    bound(cells_[other], 1);
    const int node = static_cast<int>(nodes_.size());
    for (PartitionNode& parent : nodes_)
      for (int* const child : {&parent.below, &parent.above})
        if (*child == ~i)
          *child = node;
    nodes_.push_back({exemplar, ~i, ~other});
  }
}

void Partition::add_faces(const std::vector<Exemplar>& exemplars, const std::vector<Chart>& charts,
                          const Components components_mean) {
  for (Cell& cell : cells_)
    for (int h = 0; h < static_cast<int>(cell.halves.size()); ++h) {
      const int e = cell.exemplars[h];
      const Grey section = section_in(cell, charts[e], h);
      const std::size_t n_pixels = count(section);
      if (n_pixels < least_pixels || !has_width(section, cell, charts[e], h))
        continue;
      int n = 0;
      const auto least = static_cast<std::size_t>(least_component * static_cast<double>(n_pixels)) + 1;
      const auto number = components(section, least, n);
      if (components_mean == Components::one && n > 1)
        throw refusal(
          exemplars[e], "Components",
          "the body's section has " + std::to_string(n) + " components between the same exemplars",
          "Add one more exemplar that parts them, before this one (thesis §3.4.2.1), or set Components to each or "
          "together");
      if (components_mean != Components::each) {
        cell.faces.push_back({e, cell.sides[h], section, n_pixels});
        continue;
      }
      for (int k = 1; k <= n; ++k) {
        Face face{e, cell.sides[h], Grey(section.width, section.height, 0), 0};
        for (std::size_t i = 0; i < number.values.size(); ++i)
          face.pixels.values[i] = number.values[i] == k ? 1.0f : 0.0f;
        face.area = count(face.pixels);
        cell.faces.push_back(std::move(face));
      }
    }
}

int Partition::find(const Vec3& p) const {
  int at = 0;
  do {
    const PartitionNode& node = nodes_[at];
    at = planes_[node.exemplar].height(p) > 0 ? node.above : node.below;
  } while (at >= 0);
  return ~at;
}

} // namespace kerf::texture
