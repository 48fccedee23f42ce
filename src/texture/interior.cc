#include "texture/interior.h"

#include "base/error.h"
#include "base/parallel.h"
#include "texture/enclosed.h"

#include <Eigen/LU>

#include <algorithm>
#include <bit>
#include <cmath>

namespace kerf::texture {

namespace {

/// The map of the table at a point [pixels], to all faces at once.
template <class Use>
void look_up(const WarpTable& table, const Vec2& p, const Use& use) {
  const image::Footing f =
    image::footing(table.n_columns, table.n_rows, (static_cast<float>(p[0]) - table.left) * table.columns_by_pixel,
                   (static_cast<float>(p[1]) - table.top) * table.rows_by_pixel);
  const float* const a = table.node(f.column, f.row);
  const float* const b = a + table.n_numbers;
  const float* const c = a + table.n_numbers * table.n_columns;
  const float* const d = c + table.n_numbers;
  use(a, b, c, d, f.right, f.down);
}

/// Where a point goes on face `target`, and how that changes with the point.
struct Image {
  Vec2 at;
  Mat2 gradient;
};

Image image_of(const WarpTable& table, const int target, const Vec2& p) {
  Image result;
  look_up(table, p,
          [&](const float* a, const float* b, const float* c, const float* d, const double u, const double v) {
            for (int k = 0; k < 2; ++k) {
              const int i = 2 * target + k;
              const double top = a[i] + u * (b[i] - a[i]), bottom = c[i] + u * (d[i] - c[i]);
              result.at[k] = top + v * (bottom - top);
              result.gradient(k, 0) = ((1 - v) * (b[i] - a[i]) + v * (d[i] - c[i])) * table.columns_by_pixel;
              result.gradient(k, 1) = (bottom - top) * table.rows_by_pixel;
            }
          });
  return result;
}

/// The complaint about a chart, with the exemplar's name.
Chart chart_of(const Exemplar& exemplar, const geometry::TriangleMesh& body,
               const std::optional<warp::LatticeMap>& known, std::optional<warp::LatticeMap>& used) {
  try {
    return make_chart(exemplar, body, known, used);
  } catch (const ParameterError& error) {
    Complaint complaint = error.complaint();
    complaint.value = "exemplar " + exemplar.name + (complaint.value.empty() ? "" : ", " + complaint.value);
    throw ParameterError(complaint);
  }
}

/// A cell without faces, which holds no more of the body than some pixels, sees the exemplar that parted it last,
/// whole.
Cell with_a_face(Cell cell, const std::vector<Chart>& charts) {
  if (cell.faces.empty()) {
    const int e = cell.exemplars.back();
    cell.faces.push_back({e, cell.sides.back(), charts[e].inside, 0});
    for (const float value : charts[e].inside.values)
      cell.faces.back().area += value > 0 ? 1 : 0;
  }
  return cell;
}

/// Before warps are sought, which takes long.
void require_few_faces(const std::vector<Cell>& cells, const Components components) {
  std::size_t most = 0;
  for (const Cell& cell : cells)
    most = std::max(most, cell.faces.size());
  if (most > max_sources)
    throw ParameterError(Complaint{
      .path = components == Components::each ? "Components" : "Exemplar",
      .rule = std::to_string(most) + " faces bound one cell, at most " + std::to_string(max_sources) + " are allowed",
      .remedy = components == Components::each ? "Set Components to together: then a section is one face"
                                               : "Leave exemplars out until at most " + std::to_string(max_sources) +
                                                   " of them bound a common cell"});
}

} // namespace

Interior::Interior(const std::vector<Exemplar>& exemplars, const geometry::TriangleMesh& body,
                   const InteriorOptions& options, const Maps* known)
  : options_(options), origin_(body.vertices[body.triangles.front()[0]]) {
  if (exemplars.empty())
    throw ParameterError(Complaint{.path = "Exemplar",
                                   .rule = "an interior needs at least one exemplar",
                                   .remedy = "Add a section 'subsection Exemplar NAME'"});
  maps_.fits.resize(exemplars.size());
  for (std::size_t i = 0; i < exemplars.size(); ++i) {
    charts_.push_back(chart_of(exemplars[i], body, known ? known->fits[i] : std::nullopt, maps_.fits[i]));
    pixel_ += charts_.back().plane.pixel() / static_cast<double>(exemplars.size());
  }
  partition_.emplace(exemplars, charts_, options.components);
  require_few_faces(partition_->cells(), options.components);
  check_pins(options.warps.pins, partition_->cells(), exemplars, charts_);
  cells_.resize(partition_->cells().size());
  maps_.warps.resize(cells_.size());
  parallel_for(cells_.size(), [&](const std::size_t i) { build_cell(static_cast<int>(i), exemplars, body, known); });
}

void Interior::build_cell(const int number, const std::vector<Exemplar>& exemplars, const geometry::TriangleMesh& body,
                          const Maps* known) {
  const Cell cell = with_a_face(partition_->cells()[number], charts_);
  CellData& data = cells_[number];
  const std::size_t n = cell.faces.size();
  for (const Face& face : cell.faces) {
    data.pixels.push_back(face.pixels);
    data.sources.emplace_back(face, cell, exemplars[face.exemplar], charts_[face.exemplar], body);
  }
  data.tables = make_warps(cell, exemplars, charts_, options_.warps,
                           known ? known->warps[number] : std::vector<BothWays>(), maps_.warps[number]);
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < n; ++i) {
      const Face &from = cell.faces[std::min(i, j)], &to = cell.faces[std::max(i, j)];
      const Chart &a = charts_[from.exemplar], &b = charts_[to.exemplar];
      const Mat2 linear =
        i == j ? Mat2(Mat2::Identity()) : aligned_linear(align(from, a, to, b, options_.warps.pixels), a, b);
      data.apart.push_back(i == j || !are_partners(from, to, exemplars, charts_, options_.warps) ? 1 : 0);
      data.linear.push_back(j <= i ? linear : Mat2(linear.inverse()));
    }
  data.triangles = enclosing_triangles(cell, body);
}

void Interior::find_sources(const CellData& cell, const Vec3& p, const Blending& how, Found& found) const {
  const std::size_t n = cell.sources.size();
  std::array<double, max_sources> distances;
  for (std::size_t i = 0; i < n; ++i) {
    const Source& source = cell.sources[i];
    const SectionPlane& plane = charts_[source.exemplar()].plane;
    const Source::Point point = source.find(p);
    found.locals[i] = point.local;
    found.pixels[i] = plane.to_pixels(point.local);
    distances[i] = point.distance;
  }
  shepard(std::span(distances).first(n), how.power, found.shares);
  if (how.weights == Weights::mean_value && !cell.triangles.empty())
    enclose(cell, p, found);
}

void Interior::find_sources(const CellData& cell, const Lanes* const points, const double power,
                            const std::span<Found> found) const {
  const int n = static_cast<int>(cell.sources.size());
  alignas(64) Lanes distances[max_sources], shares[max_sources], x, y;
  for (int i = 0; i < n; ++i) {
    cell.sources[i].find(points, x, y, distances[i]);
    const SectionPlane& plane = charts_[cell.sources[i].exemplar()].plane;
    for (int l = 0; l < n_lanes; ++l)
      found[l].pixels[i] = plane.to_pixels(Vec2(x[l], y[l]));
  }
  if (power == 1 || power == 2) {
    find_shares(n, static_cast<int>(power), distances, shares);
    for (int l = 0; l < n_lanes; ++l)
      for (int i = 0; i < n; ++i)
        found[l].shares[i] = shares[i][l];
    return;
  }
  std::array<double, max_sources> own;
  for (int l = 0; l < n_lanes; ++l) {
    for (int i = 0; i < n; ++i)
      own[i] = distances[i][l];
    shepard(std::span(own).first(n), power, found[l].shares);
  }
}

/// Shepard's shares become mean value coordinates where source points enclose the point.
void Interior::enclose(const CellData& cell, const Vec3& p, Found& found) const {
  std::array<Vec3, max_sources> points;
  for (std::size_t i = 0; i < cell.sources.size(); ++i)
    points[i] = charts_[cell.sources[i].exemplar()].plane.point(found.locals[i]);
  texture::enclose(p, std::span(points).first(cell.sources.size()), cell.triangles, found.shares);
}

/// (3.14) for all sources at once: each table says where its source point goes on every face.
void Interior::morph(const CellData& cell, const Found& found, std::array<Vec2, max_sources>& q) const {
  const int n = static_cast<int>(cell.sources.size());
  std::array<float, 2 * max_sources> sum;
  std::fill_n(sum.begin(), cell.tables.front().n_numbers, 0.0f);
  for (int j = 0; j < n; ++j) {
    const auto share = static_cast<float>(found.shares[j]);
    look_up(cell.tables[j], found.pixels[j],
            [&](const float* a, const float* b, const float* c, const float* d, const float u, const float v) {
              const float wa = share * (1 - u) * (1 - v), wb = share * u * (1 - v);
              const float wc = share * (1 - u) * v, wd = share * u * v;
              for (int k = 0; k < cell.tables[j].n_numbers; ++k)
                sum[k] += wa * a[k] + wb * b[k] + wc * c[k] + wd * d[k];
            });
  }
  for (int i = 0; i < n; ++i)
    q[i] = own_share(cell, found, i) * found.pixels[i] + Vec2(sum[2 * i], sum[2 * i + 1]);
}

double Interior::own_share(const CellData& cell, const Found& found, const int i) {
  const int n = static_cast<int>(cell.sources.size());
  double share = 0;
  for (int j = 0; j < n; ++j)
    share += cell.apart[j * n + i] ? found.shares[j] : 0;
  return share;
}

/// Newton's method from q, as long as it gets nearer.
Vec2 Interior::solve_inverse(const CellData& cell, const Found& found, const int i, Vec2 q) const {
  const int n = static_cast<int>(cell.sources.size());
  double before = 1e300;
  Vec2 best = q;
  for (int round = 0; round < 20; ++round) {
    const double own = own_share(cell, found, i);
    Vec2 error = own * (q - found.pixels[i]);
    Mat2 gradient = own * Mat2::Identity();
    for (int j = 0; j < n; ++j)
      if (!cell.apart[j * n + i]) {
        const Image image = image_of(cell.tables[i], j, q);
        const Mat2 back = found.shares[j] * cell.linear[j * n + i];
        error += back * (image.at - found.pixels[j]);
        gradient += back * image.gradient;
      }
    if (error.norm() < before) {
      before = error.norm();
      best = q;
    }
    if (before < 1e-6 || !(std::abs(gradient.determinant()) > 1e-9))
      break;
    const Vec2 step = gradient.inverse() * error;
    q -= step * std::min(1.0, 20 / step.norm());
  }
  return best;
}

Blend Interior::blend(const Vec3& p, const Blending& how, const int number) const {
  Blend blend;
  Found found;
  find_sources(cells_[number], p, how, found);
  mix(number, found, how, blend);
  return blend;
}

void Interior::blend(const std::span<const Vec3> points, const Blending& how,
                     const std::span<Blend* const> blends) const {
  std::array<Found, n_lanes> found;
  std::array<int, n_lanes> cells;
  alignas(64) Lanes coordinates[3];
  for (std::size_t l = 0; l < n_lanes; ++l) {
    const Vec3& p = points[std::min(l, points.size() - 1)];
    for (int k = 0; k < 3; ++k)
      coordinates[k][l] = p[k];
    if (l < points.size())
      cells[l] = partition_->find(p);
  }
  // Whatever lies in another cell than the first one's that is left waits for its own turn.
  std::uint32_t left = (1u << points.size()) - 1;
  while (left != 0) {
    const int cell = cells[std::countr_zero(left)];
    if (how.weights == Weights::shepard)
      find_sources(cells_[cell], coordinates, how.power, found);
    for (std::size_t l = 0; l < points.size(); ++l) {
      if (cells[l] != cell)
        continue;
      if (how.weights != Weights::shepard)
        find_sources(cells_[cell], points[l], how, found[l]);
      mix(cell, found[l], how, *blends[l]);
      left &= ~(1u << l);
    }
  }
}

void Interior::mix(const int number, const Found& found, const Blending& how, Blend& blend) const {
  const CellData& cell = cells_[number];
  blend.cell = number;
  blend.n = static_cast<int>(cell.sources.size());
  std::array<Vec2, max_sources> q;
  std::copy_n(found.pixels.begin(), blend.n, q.begin());
  if (how.morph == Morph::first_order || how.morph == Morph::exact_inverse)
    morph(cell, found, q);
  if (how.morph == Morph::exact_inverse)
    for (int i = 0; i < blend.n; ++i)
      q[i] = solve_inverse(cell, found, i, q[i]);
  const auto last = found.shares.begin() + blend.n;
  const auto nearest = std::max_element(found.shares.begin(), last) - found.shares.begin();
  for (int i = 0; i < blend.n; ++i) {
    blend.exemplars[i] = static_cast<std::uint8_t>(cell.sources[i].exemplar());
    blend.weights[i] = how.morph == Morph::nearest ? (i == nearest ? 1.0f : 0.0f) : static_cast<float>(found.shares[i]);
    blend.x[i] = static_cast<float>(q[i][0]);
    blend.y[i] = static_cast<float>(q[i][1]);
  }
}

Eigen::Array4f Interior::colour(const Blend& blend) const {
  Eigen::Array4f sum = Eigen::Array4f::Zero();
  for (int i = 0; i < blend.n; ++i)
    sum += blend.weights[i] * image::sample_spline(charts_[blend.exemplars[i]].spline, blend.x[i], blend.y[i]);
  return sum.max(0.0f).min(1.0f);
}

std::size_t Interior::n_pairs() const {
  std::size_t n = 0;
  for (const auto& maps : maps_.warps)
    n += maps.size();
  return n;
}

std::size_t Interior::n_closed_cells() const {
  return static_cast<std::size_t>(
    std::count_if(cells_.begin(), cells_.end(), [](const CellData& cell) { return !cell.triangles.empty(); }));
}

/// Where a pixel of a chart lies in its picture.
Vec2 Interior::in_picture(const int exemplar, const Vec2& pixel) const {
  const auto& fit = maps_.fits[exemplar];
  return fit ? (*fit)(fit->lower + pixel) : pixel;
}

void Interior::count_folds(const CellData& cell, const int from, const int to, Folds& folds) const {
  const image::Grey& pixels = cell.pixels[from];
  const int n = static_cast<int>(cell.sources.size()), a = cell.sources[from].exemplar(),
            b = cell.sources[to].exemplar();
  const double sense = cell.linear[from * n + to].determinant();
  const auto turns = [](const Vec2& p, const Vec2& q, const Vec2& r) {
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
  };
  const auto check = [&](const std::array<Vec2, 3>& p) {
    std::array<Vec2, 3> before, after;
    for (int k = 0; k < 3; ++k) {
      before[k] = in_picture(a, p[k]);
      after[k] = in_picture(b, image_of(cell.tables[from], to, p[k]).at);
    }
    ++folds.n_triangles;
    folds.n_flipped +=
      turns(before[0], before[1], before[2]) > 0 && sense * turns(after[0], after[1], after[2]) > 0 ? 0 : 1;
  };
  for (int r = 0; r + 1 < pixels.height; ++r)
    for (int c = 0; c + 1 < pixels.width; ++c)
      if (std::min({pixels(c, r), pixels(c + 1, r), pixels(c, r + 1), pixels(c + 1, r + 1)}) > 0.5f)
        for (const Vec2& at : {Vec2(c, r), Vec2(c + 0.5, r + 0.5)})
          check({at, at + Vec2(1e-3, 0), at + Vec2(0, 1e-3)});
}

Interior::Folds Interior::folds() const {
  Folds folds;
  for (const CellData& cell : cells_) {
    const int n = static_cast<int>(cell.sources.size());
    for (int from = 0; from < n; ++from)
      for (int to = 0; to < n; ++to)
        if (!cell.apart[from * n + to])
          count_folds(cell, from, to, folds);
  }
  return folds;
}

double Interior::smallest_determinant() const {
  double smallest = 1e300;
  for (const auto& maps : maps_.warps)
    for (const BothWays& pair : maps)
      for (const warp::LatticeMap* const map : {&pair.there, &pair.back})
        smallest = std::min(smallest, warp::smallest_determinant(*map));
  for (const auto& fit : maps_.fits)
    if (fit)
      smallest = std::min(smallest, warp::smallest_determinant(*fit));
  return smallest;
}

} // namespace kerf::texture
