#include "tests/grinder/look.h"

#include "base/parameters.h"
#include "grid/locate.h"
#include "scene/observables.h"
#include "tests/grinder/draw.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>

namespace kerf::grinder {

namespace {

double observed(const scene::Body& body, const std::string& name) { return scene::find_observable(name)->value(body); }

bool particles_are_corners(const scene::Body& body) { return body.state.x.size() == body.solid.complex.n_corners(); }

std::vector<std::uint32_t> pieces_of_particles(const scene::Body& body, const grid::Pieces& pieces) {
  if (particles_are_corners(body))
    return grid::corner_pieces(body.solid.complex);
  std::vector<std::uint32_t> piece;
  for (const Vec3& rest : body.physics->rest())
    piece.push_back(pieces.piece[grid::copy_around(body.solid, rest)]);
  return piece;
}

bool is_finite(const scene::Body& body) {
  double sum = 0;
  for (const Points* points : {&body.state.x, &body.state.v, &scene::corners(body), &scene::positions(body)})
    for (const Vec3& p : *points)
      sum += p.sum();
  return std::isfinite(sum);
}

/// Their 99th percentile; 1 of none.
double ordinary(std::vector<double> values) {
  if (values.empty())
    return 1;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Of a particle [cubes].
double mass_of(const scene::Body& body, const std::size_t particle) {
  return body.physics->model().lumped_mass()[particle] / (body.density * std::pow(body.solid.grid.h(), 3));
}

void look_at_speeds(const scene::Body& body, const grid::Pieces& pieces, const double least_mass,
                    std::vector<PieceLook>& looks) {
  const auto piece = pieces_of_particles(body, pieces);
  std::vector<std::vector<double>> speeds(looks.size());
  for (std::size_t i = 0; i < piece.size(); ++i) {
    PieceLook& look = looks[piece[i]];
    const double speed = body.state.v[i].norm();
    speeds[piece[i]].push_back(speed);
    if (speed >= look.fastest && mass_of(body, i) >= least_mass) {
      look.fastest = speed;
      look.who = i;
    }
  }
  for (std::size_t p = 0; p < looks.size(); ++p) {
    looks[p].n_particles = speeds[p].size();
    if (speeds[p].empty())
      continue;
    looks[p].ordinary = ordinary(speeds[p]);
  }
}

void look_at_supports(const scene::Body& body, const grid::Pieces& pieces, std::vector<PieceLook>& looks) {
  const auto piece = pieces_of_particles(body, pieces);
  for (const dynamics::Support& support : body.loads.supports)
    for (const auto particle : support.corners)
      looks[piece[particle]].is_held = true;
}

double stretch_of_material(const scene::Body& body) {
  const Points& x = scene::corners(body);
  std::vector<double> all;
  for (const grid::Copy& copy : body.solid.complex.copies) {
    if (std::popcount(copy.nodes) < 4)
      continue;
    double longest = 0;
    for (const auto& [a, b] : grid::cube::line_vertices)
      longest = std::max(longest, (x[copy.corners[a].value] - x[copy.corners[b].value]).norm());
    all.push_back(longest / body.solid.grid.h());
  }
  return ordinary(std::move(all));
}

/// Six times the volume of a triangle's cone from `origin`.
double cone(const Points& x, const Triangle& t, const Vec3& origin) {
  return (x[t[0]] - origin).dot((x[t[1]] - origin).cross(x[t[2]] - origin));
}

/// Volumes and reaches, both about the mean of a piece's vertices, which keeps splinters exact.
void look_at_surface(const scene::Body& body, const grid::Pieces& pieces, std::vector<PieceLook>& looks) {
  const surface::Surface& surface = body.surface;
  const Points* const both[] = {&surface.rest, &scene::positions(body)};
  for (int now = 0; now < 2; ++now) {
    const Points& x = *both[now];
    Points mean(looks.size(), Vec3::Zero());
    std::vector<double> n(looks.size(), 0);
    const auto piece_of = [&](const std::size_t i) { return pieces.piece[surface.copies[i]]; };
    for (std::size_t i = 0; i < surface.triangles.size(); ++i)
      for (const std::uint32_t v : surface.triangles[i]) {
        mean[piece_of(i)] += x[v];
        ++n[piece_of(i)];
      }
    for (std::size_t p = 0; p < looks.size(); ++p)
      mean[p] /= std::max(n[p], 1.0);
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
      PieceLook& look = looks[piece_of(i)];
      const Vec3& middle = mean[piece_of(i)];
      (now ? look.volume : look.rest_volume) += cone(x, surface.triangles[i], middle) / 6;
      double& reach = now ? look.reach : look.rest_reach;
      for (const std::uint32_t v : surface.triangles[i])
        reach = std::max(reach, (x[v] - middle).norm());
    }
  }
}

} // namespace

Look look_at(const scene::Body& body, const double least_mass) {
  Look look{.is_finite = is_finite(body)};
  if (!look.is_finite)
    return look;
  const grid::Pieces pieces = grid::pieces(body.solid.complex);
  look.pieces.resize(pieces.n_pieces);
  look_at_speeds(body, pieces, least_mass, look.pieces);
  look_at_surface(body, pieces, look.pieces);
  look_at_supports(body, pieces, look.pieces);
  look.stretch = stretch_of_material(body);
  look.kinetic = observed(body, "kinetic energy");
  look.elastic = observed(body, "elastic energy");
  look.gravity = observed(body, "gravity energy");
  look.missing = observed(body, "missing energy");
  look.work_of_cut = observed(body, "work of the cut");
  return look;
}

std::string about_particle(const scene::Body& body, const std::size_t particle) {
  const Vec3& rest = body.physics->rest()[particle];
  std::string words = "at rest at " + text(rest) + " m, of mass " + to_text(mass_of(body, particle)) + " cubes";
  if (!particles_are_corners(body))
    return words;
  words += ", known to copies with";
  for (const auto c : ids<grid::CopyId>(body.solid.complex.n_copies())) {
    const grid::Copy& copy = body.solid.complex.copies[c];
    for (const grid::CornerId corner : copy.corners)
      if (corner.value == particle)
        words += " [" + std::to_string(std::popcount(copy.nodes)) + " nodes, " +
                 std::to_string(std::popcount(copy.skin)) + " points of the skin]";
  }
  const grid::NodeId node = body.solid.complex.node[grid::CornerId(particle)];
  if (!node.valid())
    return words + "none: it has lapsed";
  return words + (body.solid.complex.real_corner[node].value == particle ? ", real" : ", virtual");
}

} // namespace kerf::grinder
