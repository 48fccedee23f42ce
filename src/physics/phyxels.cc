#include "physics/phyxels.h"

#include "base/union_find.h"
#include "dynamics/relief.h"
#include "grid/locate.h"
#include "physics/carry_all.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace kerf::physics {

namespace {

bool comes_before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

bool looks_for_ways_around(const std::string& criterion) {
  return criterion == "diffraction" || criterion == "transparency";
}

enum class Part { skin, cuts };

/// The corners of each face in one order: both sides of a cut are one face. Where a cut ends in a cell, its front has
/// them.
std::vector<visibility::Face> faces_of(const CutBody& body, const Part part) {
  const surface::Surface& surface = body.surface;
  std::vector<visibility::Face> faces;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if ((surface.labels[t] == 0) != (part == Part::skin))
      continue;
    const grid::Front* const front = body.solid.cuts.front(body.solid.complex.copies[surface.copies[t]].cell);
    if (front && front->label == surface.labels[t])
      continue;
    visibility::Face& face = faces.emplace_back();
    for (int k = 0; k < 3; ++k)
      face[k] = surface.rest[surface.triangles[t][k]];
    std::sort(face.begin(), face.end(), comes_before);
  }
  return faces;
}

/// Of cuts that end inside cells, in these: what they have come to, and what that sweeps as far on as it seems too short
/// to phyxels [m].
std::vector<visibility::Face> faces_of_fronts(const grid::Solid& solid, const std::vector<grid::CellId>& cells,
                                              const double lag) {
  std::vector<visibility::Face> faces;
  for (const grid::CellId c : cells)
    if (const grid::Front* const front = solid.cuts.front(c))
      for (const Points& come : front->come) {
        for (std::size_t i = 2; i < come.size(); ++i)
          faces.push_back({come[0], come[i - 1], come[i]});
        const Vec3 on = lag * front->onward,
                   middle = std::accumulate(come.begin(), come.end(), Vec3(Vec3::Zero())) / double(come.size());
        for (std::size_t i = 0; i < come.size(); ++i) {
          const Vec3 &a = come[i], &b = come[(i + 1) % come.size()], across = front->normal.cross(b - a);
          if (across.dot(a - middle) * across.dot(on) > 0) { // the way on leads out here
            faces.push_back({a, b, b + on});
            faces.push_back({a, b + on, a + on});
          }
        }
      }
  return faces;
}

/// Pseudo-inverse of a symmetric matrix whose small eigenvalues say nothing.
Mat3 inverse_where_known(const Mat3& A) {
  constexpr double smallest = 1e-6;
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(A);
  Vec3 inverse = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    if (eigen.eigenvalues()[k] > smallest * eigen.eigenvalues()[2])
      inverse[k] = 1 / eigen.eigenvalues()[k];
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

/// The sights of pairs first, first + 1, ... as a criterion sees them now.
void copy(const visibility::Sights& from, const std::size_t first, std::vector<pba::Sight>& to) {
  for (std::size_t p = 0; p < to.size(); ++p)
    to[p] = from[visibility::PairId(static_cast<std::uint32_t>(first + p))];
}

std::vector<visibility::Pair> pairs_of(const Points& from, const Points& to, const std::vector<pba::Pair>& pairs,
                                       const std::vector<double>& support) {
  std::vector<visibility::Pair> all;
  for (std::size_t p = 0; p < pairs.size(); ++p)
    all.push_back({from[pairs[p][0]], to[pairs[p][1]], support[p]});
  return all;
}

} // namespace

Phyxels::Made Phyxels::make(const CutBody& body, const PhyxelsOptions& options) {
  pba::Phyxels phyxels = pba::fill(body.solid, options.phyxels);
  const auto copies = grid::copies_around(body.solid, phyxels.rest);
  const auto reached = pba::reached_copies(body.solid, phyxels, copies);
  pba::NodePairs node_pairs = pba::reached_node_pairs(body.solid, phyxels, reached);
  pba::Neighbours neighbours = pba::reached_neighbours(phyxels, copies, reached);
  return {{std::move(phyxels), std::move(neighbours), options.material, options.model}, std::move(node_pairs)};
}

bool Phyxels::ByCoordinates::operator()(const Face& a, const Face& b) const {
  for (int k = 0; k < 3; ++k)
    if (a[k] != b[k])
      return comes_before(a[k], b[k]);
  return false;
}

Phyxels::Phyxels(const CutBody& body, const PhyxelsOptions& options, StepperMaker make_stepper)
  : Phyxels(body, options, std::move(make_stepper), make(body, options)) {}

Phyxels::Phyxels(const CutBody& body, const PhyxelsOptions& options, StepperMaker make_stepper, Made made)
  : options_(options),
    make_stepper_(std::move(make_stepper)),
    model_(std::move(made.model)),
    node_pairs_(std::move(made.node_pairs)),
    crumbs_(body.density),
    now_(rest()) {
  const auto& neighbours = model_.neighbours();
  sights_of_phyxels_ = pba::clear_sights(rest(), rest(), neighbours.pairs);
  sights_of_nodes_ = pba::clear_sights(node_pairs_.rest, rest(), node_pairs_.pairs);
  find_pieces(body);
  dynamics::State at_rest{rest(), Points(rest().size(), Vec3::Zero())};
  follow_crumbs(
    body,
    [&] {
      return Motion{grid::rest_positions(body.solid), Points(body.solid.complex.n_corners(), Vec3::Zero())};
    },
    at_rest);
  build_map(body);
  stepper_ = make_stepper_(model_, [this] { return phyxel_pieces_; });
  follow(state_at_rest(*this));
}

dynamics::StepReport Phyxels::step(dynamics::State& state, const dynamics::Loads& loads, const double dt) {
  dynamics::StepReport report;
  if (carry_all(crumbs_))
    state.time += dt;
  else
    report = stepper_->step(state, loads, dt);
  crumbs_.step(loads, dt, stepper_->motion(), state);
  return report;
}

void Phyxels::begin_to_look(const CutBody& body) {
  const std::vector<Face> skin = faces_of(body, Part::skin);
  sights_.emplace(visibility::make_criterion(options_.visibility.choice, skin));
  const auto& neighbours = model_.neighbours();
  sights_->watch(visibility::PairId(0), pairs_of(rest(), rest(), neighbours.pairs, neighbours.support));
  sights_->watch(visibility::PairId(static_cast<std::uint32_t>(neighbours.pairs.size())),
                 pairs_of(node_pairs_.rest, rest(), node_pairs_.pairs, node_pairs_.support));
  if (looks_for_ways_around(options_.visibility.choice.criterion))
    add_faces(skin);
}

void Phyxels::add_faces(const std::vector<Face>& faces) {
  std::vector<Face> fresh;
  for (const Face& face : faces)
    if (faces_.insert(face).second)
      fresh.push_back(face);
  sights_->add_faces(fresh);
}

void Phyxels::find_pieces(const CutBody& body) {
  copies_ = grid::copies_around(body.solid, rest());
  phyxel_pieces_ = pba::phyxel_pieces(body.solid.complex, copies_);
  node_pieces_ = pba::node_pieces(body.solid.complex, node_pairs_);
}

std::vector<pba::Link> Phyxels::missing_links(const CutBody& body) const {
  constexpr double least = 0.1; // weight that holds: what a link of a quarter of a cube weighs across two of them
  const auto& pairs = model_.neighbours().pairs;
  UnionFind parts(rest().size());
  for (std::size_t p = 0; p < pairs.size(); ++p)
    if (model_.weights()[p] > least)
      parts.unite(pairs[p][0], pairs[p][1]);
  std::map<std::uint32_t, std::uint32_t> part_of; // of pieces
  bool is_joined = true;
  for (std::uint32_t i = 0; i < rest().size() && is_joined; ++i)
    if (copies_[i].valid() && !crumbs_.carries(i))
      is_joined = part_of.try_emplace(phyxel_pieces_[i], parts.root(i)).first->second == parts.root(i);
  if (is_joined)
    return {};
  std::vector<pba::Link> links = pba::find_links(body.solid, rest(), copies_);
  std::erase_if(links, [&](const pba::Link& link) {
    return parts.root(link.pair[0]) == parts.root(link.pair[1]) || crumbs_.carries(link.pair[0]);
  });
  const double h = body.solid.grid.h();
  for (pba::Link& link : links)
    link.area = std::max(link.area, grid::well_filled * h * h);
  return links;
}

void Phyxels::build_map(const CutBody& body) {
  if (copies_.empty())
    find_pieces(body);
  std::vector<pba::Sight> parted = sights_of_nodes_;
  pba::part(node_pairs_.pairs, node_pieces_, phyxel_pieces_, parted);
  map_ = pba::build_corner_map(body.solid, model_.phyxels(), copies_, node_pairs_, parted);
  parted = sights_of_phyxels_;
  pba::part(model_.neighbours().pairs, phyxel_pieces_, phyxel_pieces_, parted);
  leave_out_crumbs(model_.neighbours().pairs, parted);
  const pba::Deformed before = model_.deformed(now_);
  model_.update(parted);
  model_.link(missing_links(body), now_, before);
  is_stale_ = false;
}

void Phyxels::leave_out_crumbs(const std::vector<pba::Pair>& pairs, std::vector<pba::Sight>& sights) const {
  if (crumbs_.any())
    for (std::size_t p = 0; p < pairs.size(); ++p)
      if (crumbs_.carries(pairs[p][0])) // then the other end too: they are of one piece
        sights[p].factor = 0;
}

void Phyxels::follow_crumbs(const CutBody& body, const std::function<Motion()>& motion_of_corners,
                            dynamics::State& state) {
  if (!body.solid.crumbs.any() && !crumbs_.any())
    return;
  std::vector<std::uint32_t> crumb_of_copy(body.solid.complex.n_copies(), CrumbParticles::none), crumb_of_phyxel;
  for (std::uint32_t b = 0; b < body.solid.crumbs.all.size(); ++b)
    for (const grid::CopyId c : body.solid.crumbs.all[b].copies)
      crumb_of_copy[c.value] = b;
  std::vector<double> mass;
  for (std::size_t i = 0; i < copies_.size(); ++i) {
    crumb_of_phyxel.push_back(copies_[i].valid() ? crumb_of_copy[copies_[i].value] : CrumbParticles::none);
    mass.push_back(body.density * model_.phyxels().volume[i]);
  }
  const CrumbParticles particles{std::move(crumb_of_phyxel), mass, rest()};
  crumbs_.follow(body.solid, &particles, motion_of_corners, state);
  model_.carry(crumbs_.carried());
}

void Phyxels::follow_cut(const CutBody& body, const grid::CutChange& change, dynamics::State& state) {
  if (!sights_)
    begin_to_look(body);
  add_faces(faces_of(body, Part::cuts));
  add_faces(faces_of_fronts(body.solid, change.cells, pba::front_lag(model_.phyxels())));
  find_pieces(body);
  const Vec3 had = momentum(model_.lumped_mass(), crumbs_, state);
  const std::vector<std::uint8_t> carried = crumbs_.carried();
  follow_crumbs(
    body,
    [&] { // by the map from before the cut
      Motion now{corners_, {}};
      const Interpolation carried = carry(corners_themselves(corners_.size()));
      for (std::size_t i = 0; i < corners_.size(); ++i)
        now.v.push_back(carried.at(i, state.v));
      crumbs_.put_velocities(state, now.v);
      grid::inherit(change, now.x);
      grid::inherit(change, now.v);
      return now;
    },
    state);
  std::vector<std::uint32_t> freed;
  for (std::uint32_t i = 0; i < carried.size(); ++i)
    if (carried[i] != 0 && !crumbs_.carries(i))
      freed.push_back(i);
  if (!freed.empty())
    restore_momentum(had, freed, model_.lumped_mass(), crumbs_, state);
  is_stale_ = true;
  const std::vector<double> weights(model_.weights().begin(), model_.weights().end());
  if (options_.visibility.budget == 0)
    catch_up(body);
  else
    build_map(body); // pieces part at once; what the step may look at, it looks at in its own catch_up()
  find_touched(weights);
  dynamics::forget_forces(state);
  stepper_ = make_stepper_(model_, [this] { return phyxel_pieces_; });
  follow(state);
}

void Phyxels::find_touched(const std::vector<double>& weights_before) {
  touched_.assign(rest().size(), 0);
  const auto& pairs = model_.neighbours().pairs;
  for (std::size_t p = 0; p < pairs.size(); ++p)
    if (model_.weights()[p] != weights_before[p])
      for (const auto i : pairs[p])
        touched_[i] = 1;
}

void Phyxels::let_out(const CutBody&, const grid::CutChange&, const EnergyBefore& had,
                      const dynamics::Loads& loads, dynamics::State& state) {
  if (stepper_->motion() != dynamics::MotionKind::dynamic)
    return;
  crumbs_.let_out(loads, had.of_loads, state);
  if (carry_all(crumbs_)) {
    follow(state);
    return;
  }
  dynamics::Relief relief(model_, {.most = dynamics::most_after_cut(model_, had.elastic, state.v),
                                   .touched = touched_,
                                   .piece = [this] { return phyxel_pieces_; }});
  relief.step(state, loads, 0);
  follow(state);
}

bool Phyxels::catch_up(const CutBody& body) {
  if (!sights_)
    return false;
  const int budget = options_.visibility.budget;
  const auto progress =
    sights_->update(budget > 0 ? static_cast<std::size_t>(budget) : std::numeric_limits<std::size_t>::max());
  if (progress.changed.empty() && !is_stale_)
    return false;
  copy(sights_->sights(), 0, sights_of_phyxels_);
  copy(sights_->sights(), sights_of_phyxels_.size(), sights_of_nodes_);
  build_map(body);
  stepper_ = make_stepper_(model_, [this] { return phyxel_pieces_; });
  return true;
}

void Phyxels::archive(Archive& a, const CutBody& body) {
  bool looks = sights_.has_value();
  a(looks);
  if (looks && !sights_)
    sights_.emplace(visibility::make_criterion(options_.visibility.choice));
  if (looks)
    a(*sights_);
  a(model_, crumbs_, sights_of_phyxels_, sights_of_nodes_, map_, is_stale_, faces_, now_);
  if (a.reads()) {
    find_pieces(body);
    stepper_ = make_stepper_(model_, [this] { return phyxel_pieces_; });
  }
  a(*stepper_);
}

void Phyxels::follow(const dynamics::State& state) {
  now_ = state.x;
  model_.deformation(state.x, F_);
  pba::follow(map_, state.x, F_, corners_);
  crumbs_.place_corners(state, corners_);
}

void Phyxels::add_row(const std::uint32_t row, const Vec3& point, const double factor,
                      std::vector<std::uint32_t>& phyxels, std::vector<double>& weights) const {
  const auto begin = map_.rows.start[row], end = map_.rows.start[row + 1];
  Vec3 middle = Vec3::Zero();
  for (auto k = begin; k < end; ++k)
    middle += map_.rows.values[k] * map_.rest[map_.rows.columns[k]];
  Mat3 A = Mat3::Zero();
  for (auto k = begin; k < end; ++k) {
    const Vec3 d = map_.rest[map_.rows.columns[k]] - middle;
    A += map_.rows.values[k] * d * d.transpose();
  }
  const Vec3 slope = inverse_where_known(A) * (point - middle);
  for (auto k = begin; k < end; ++k) {
    phyxels.push_back(map_.rows.columns[k]);
    weights.push_back(factor * map_.rows.values[k] * (1 + slope.dot(map_.rest[map_.rows.columns[k]] - middle)));
  }
}

Interpolation Phyxels::carry(const Interpolation& of_corners) const {
  Interpolation of_phyxels;
  std::vector<std::uint32_t> phyxels;
  std::vector<double> weights;
  for (std::size_t i = 0; i < of_corners.n_points(); ++i) {
    phyxels.clear();
    weights.clear();
    for (auto k = of_corners.start[i]; k < of_corners.start[i + 1]; ++k) {
      const auto corner = of_corners.columns[k];
      const auto first = map_.source_start[corner], last = map_.source_start[corner + 1];
      for (auto s = first; s < last; ++s)
        add_row(map_.source[s], map_.corners[corner], of_corners.values[k] / (last - first), phyxels, weights);
    }
    of_phyxels.add_row(phyxels, weights);
  }
  return of_phyxels;
}

} // namespace kerf::physics
