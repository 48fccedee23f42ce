#include "dynamics/rigid_modes.h"

#include "base/error.h"
#include "base/parameters.h"
#include "dynamics/forces.h"
#include "dynamics/points.h"
#include "dynamics/state.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <cmath>

namespace kerf::dynamics {

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Kernel = Eigen::Matrix<double, 6, Eigen::Dynamic>;

constexpr double round_off_of_modes = 1e-9;

struct Piece {
  double mass = 0;
  Vec3 centre = Vec3::Zero();
  double radius = 0; ///< of gyration: what makes rotations lengths [m]
  Matrix6 moving = Matrix6::Zero(), held = Matrix6::Zero(), loaded = Matrix6::Zero();
};

/// Displacements of a point by the six modes; rotations by 1 / radius.
Eigen::Matrix<double, 3, 6> modes_at(const Piece& piece, const Vec3& x) {
  Eigen::Matrix<double, 3, 6> modes = Eigen::Matrix<double, 3, 6>::Zero();
  modes.leftCols<3>().setIdentity();
  if (piece.radius > 0)
    for (int k = 0; k < 3; ++k)
      modes.col(3 + k) = Vec3::Unit(k).cross(x - piece.centre) / piece.radius;
  return modes;
}

std::vector<Piece> pieces_of(const ForceModel& model, const Points& x, const std::span<const std::uint32_t> piece) {
  std::vector<Piece> pieces(1);
  const auto mass = model.lumped_mass();
  const auto of = [&](const std::size_t i) -> Piece& {
    const std::size_t p = piece.empty() ? 0 : piece[i];
    if (p >= pieces.size())
      pieces.resize(p + 1);
    return pieces[p];
  };
  for (std::size_t i = 0; i < x.size(); ++i) {
    of(i).mass += mass[i];
    of(i).centre += mass[i] * x[i];
  }
  for (Piece& p : pieces)
    p.centre = per_mass(p.centre, p.mass);
  for (std::size_t i = 0; i < x.size(); ++i)
    of(i).radius += per_mass(mass[i], of(i).mass) * (x[i] - of(i).centre).squaredNorm();
  for (Piece& p : pieces)
    p.radius = std::sqrt(p.radius);
  return pieces;
}

/// Fills what supports and loads make of the modes.
void add_resistance(const ForceModel& model, const Loads& loads, const double time, const Points& x,
                    const std::span<const std::uint32_t> piece, std::vector<Piece>& pieces) {
  const Constraints constraints(loads, x.size());
  const Points rest(x.size(), Vec3::Zero());
  const LoadTangent tangent = load_tangent(loads, Tangent::positive, {time, x, rest}, 0);
  const auto of = [&](const std::size_t i) -> Piece& { return pieces[piece.empty() ? 0 : piece[i]]; };
  const auto mass = model.lumped_mass();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto modes = modes_at(of(i), x[i]);
    of(i).moving += per_mass(mass[i], of(i).mass) * modes.transpose() * modes;
    of(i).held += modes.transpose() * (Mat3::Identity() - constraints.freedom(i).project) * modes;
  }
  for (int k = 0; k < 6; ++k) {
    Points mode(x.size()), force(x.size(), Vec3::Zero());
    for (std::size_t i = 0; i < x.size(); ++i)
      mode[i] = modes_at(of(i), x[i]).col(k);
    tangent.add_product(flat(mode), flat(force));
    for (std::size_t i = 0; i < x.size(); ++i)
      of(i).loaded.col(k) += modes_at(of(i), x[i]).transpose() * force[i];
  }
}

/// Orthonormal columns that span the eigenvectors of a symmetric matrix whose eigenvalues are, or are not, nothing.
enum class Part { kernel, range };
Eigen::MatrixXd part_of(const Eigen::MatrixXd& A, const Part part) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  const double largest = std::max(1e-300, eigen.eigenvalues().cwiseAbs().maxCoeff());
  Eigen::MatrixXd columns(A.rows(), 0);
  for (Eigen::Index k = 0; k < A.rows(); ++k)
    if ((eigen.eigenvalues()[k] <= round_off_of_modes * largest) == (part == Part::kernel)) {
      columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
      columns.rightCols<1>() = eigen.eigenvectors().col(k);
    }
  return columns;
}

/// The free modes of a piece as columns of six coefficients, orthonormal.
Kernel kernel_of(const Piece& piece) {
  const Eigen::MatrixXd B = part_of(piece.moving, Part::range);
  const double loaded = piece.loaded.cwiseAbs().maxCoeff();
  const Matrix6 resisting = piece.held + (loaded > 0 ? Matrix6(piece.loaded / loaded) : Matrix6(Matrix6::Zero()));
  return B * part_of(B.transpose() * resisting * B, Part::kernel);
}

std::string text_of(const Vec3& v) {
  const auto rounded = [](const double value) { return to_text(std::round(1e4 * value) / 1e4 + 0.0); };
  return "(" + rounded(v[0]) + ", " + rounded(v[1]) + ", " + rounded(v[2]) + ")";
}

std::string name_of(const FreeMode& mode) {
  if (mode.rotation.norm() < 1e-6 * mode.translation.norm())
    return "translation along " + text_of(mode.translation.normalized());
  const Vec3 on_axis = mode.centre + mode.rotation.cross(mode.translation) / mode.rotation.squaredNorm();
  return "rotation about the axis " + text_of(mode.rotation.normalized()) + " through " + text_of(on_axis);
}

FreeMode mode_of(const Piece& piece, const std::uint32_t index, const Vector6& coefficients) {
  return {index, piece.centre, coefficients.head<3>(),
          piece.radius > 0 ? Vec3(coefficients.tail<3>() / piece.radius) : Vec3(Vec3::Zero()), ""};
}

/// Either sign is as good: the first component of the rotation, else of the translation, is positive.
Vector6 with_sign(const Vector6& mode) {
  for (const int k : {3, 4, 5, 0, 1, 2})
    if (std::abs(mode[k]) > 1e-6)
      return mode[k] < 0 ? Vector6(-mode) : mode;
  return mode;
}

/// First the six by name, then what is left of the kernel.
void name_modes(const Piece& piece, const std::uint32_t index, Kernel kernel, std::vector<FreeMode>& modes) {
  static const char* const names[] = {"translation along x", "translation along y", "translation along z",
                                      "rotation about x",    "rotation about y",    "rotation about z"};
  for (int k = 0; k < 6; ++k) {
    const Vector6 unit = Vector6::Unit(k);
    if (kernel.cols() == 0 || (kernel * (kernel.transpose() * unit) - unit).norm() > 1e-6)
      continue;
    modes.push_back(mode_of(piece, index, unit));
    modes.back().name = names[k];
    kernel.row(k).setZero();
  }
  if (kernel.cols() == 0)
    return;
  const Eigen::MatrixXd outer = kernel * kernel.transpose();
  if (outer.cwiseAbs().maxCoeff() < 1e-6)
    return;
  const Kernel rest = part_of(outer, Part::range);
  for (Eigen::Index k = 0; k < rest.cols(); ++k) {
    modes.push_back(mode_of(piece, index, with_sign(rest.col(k))));
    modes.back().name = name_of(modes.back());
  }
}

} // namespace

std::vector<FreeMode> free_rigid_modes(const ForceModel& model, const Loads& loads, const double time, const Points& x,
                                       const std::span<const std::uint32_t> piece) {
  std::vector<Piece> pieces = pieces_of(model, x, piece);
  add_resistance(model, loads, time, x, piece, pieces);
  std::vector<FreeMode> modes;
  for (std::uint32_t p = 0; p < pieces.size(); ++p)
    if (pieces[p].mass > 0)
      name_modes(pieces[p], p, kernel_of(pieces[p]), modes);
  return modes;
}

FreeMotions::FreeMotions(const std::vector<FreeMode>& modes, const std::span<const std::uint32_t> piece,
                         const std::span<const double> mass, const Points& x)
  : mass_(mass.begin(), mass.end()) {
  std::size_t first = 0; // of this piece
  for (std::size_t k = 0; k < modes.size(); ++k) {
    if (modes[k].piece != modes[first].piece)
      first = k;
    Motion motion;
    for (std::uint32_t i = 0; i < x.size(); ++i)
      if ((piece.empty() ? 0 : piece[i]) == modes[k].piece && mass[i] > 0) {
        motion.corners.push_back(i);
        motion.d.push_back(modes[k].translation + modes[k].rotation.cross(x[i] - modes[k].centre));
      }
    const auto product = [&](const Points& a, const Points& b) {
      double sum = 0;
      for (std::size_t i = 0; i < a.size(); ++i)
        sum += mass[motion.corners[i]] * a[i].dot(b[i]);
      return sum;
    };
    for (std::size_t before = first; before < k; ++before)
      motion.d = moved(motion.d, -product(motion.d, motions_[before].d), motions_[before].d);
    const double length = std::sqrt(product(motion.d, motion.d));
    for (Vec3& d : motion.d)
      d /= length;
    motions_.push_back(std::move(motion));
  }
}

void FreeMotions::relieve_forces(const std::span<double> forces) const {
  for (const auto& [corners, d] : motions_) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i)
      sum += d[i].dot(at(forces, corners[i]));
    for (std::size_t i = 0; i < corners.size(); ++i)
      at(forces, corners[i]) -= sum * mass_[corners[i]] * d[i];
  }
}

void FreeMotions::relieve_motion(const std::span<double> motion) const {
  for (const auto& [corners, d] : motions_) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i)
      sum += mass_[corners[i]] * d[i].dot(at(motion, corners[i]));
    for (std::size_t i = 0; i < corners.size(); ++i)
      at(motion, corners[i]) -= sum * d[i];
  }
}

double FreeMotions::part_out_of_balance(const std::size_t motion, const Points& forces) const {
  const auto& [corners, d] = motions_[motion];
  double sum = 0, all = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    sum += d[i].dot(forces[corners[i]]);
    all += std::abs(d[i].dot(forces[corners[i]]));
  }
  return all > 0 ? std::abs(sum) / all : 0;
}

void require_supported(const std::vector<FreeMode>& modes) {
  if (modes.empty())
    return;
  const bool several = modes.front().piece != 0 || modes.back().piece != 0;
  std::string names;
  std::size_t n_named = 0;
  for (const FreeMode& mode : modes) {
    if (++n_named > 12) { // two pieces' worth
      names += ", and " + std::to_string(modes.size() - n_named + 1) + " more";
      break;
    }
    names += (names.empty() ? "" : ", ") + mode.name;
    if (several)
      names += " of piece " + std::to_string(mode.piece) + " around " + text_of(mode.centre) + " m";
  }
  const std::string of_pieces = several ? "; smaller cubes may join pieces that thin parts have left" : "";
  throw ParameterError(Complaint{.rule = "nothing resists these rigid motions, so there is no static answer: " + names,
                                 .remedy = "Add supports or handles, or use a dynamic integrator" + of_pieces});
}

} // namespace kerf::dynamics
