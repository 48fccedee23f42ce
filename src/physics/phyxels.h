#pragma once

/// Point-based animation as a backend: the particles are phyxels, the corners follow those that they see (thesis
/// §2.6.1), and a criterion says what the cut leaves to see (§2.3.1, §2.6.2).
///
/// A piece may hang together by less than its phyxels can tell: by copies in which none lies, or by what a cut has left
/// behind its front. Parts of a piece that no bond joins are linked (pba/links.h) wherever the copies join them, as
/// stiffly as a web of that material, though not less than of a quarter of a cube, as near-empty copies of elements
/// are. Bonds too light to hold join nothing.
///
/// After a cut, its faces come between pairs of phyxels, and between corners and phyxels, under a budget of pairs a
/// step: catch_up(). What lies in different pieces is parted at once, whatever the criterion has seen. Nothing of all
/// that exists before the first cut.
///
/// The faces are those of the surface that cuts have revealed, in the rest configuration, each once; where a later cut
/// moves a vertex, the moved faces come beside the earlier ones. Where a cut ends inside a cell, what it has come to is a
/// face there in place of them (Front, grid/cuts.h), longer by what a cut seems too short to phyxels (pba::front_lag).
/// Criteria that look for ways around a cut see the skin too; to extended visibility it tells which part of a disk is in
/// the body.

#include "pba/corners.h"
#include "pba/model.h"
#include "physics/physics.h"
#include "visibility/pair_sights.h"

#include <array>
#include <optional>
#include <set>

namespace kerf::physics {

struct VisibilityOptions {
  visibility::CriterionChoice choice;
  int budget = 0; ///< pairs looked at in a step, at most; 0: all

  void describe(Parameters& p) {
    choice.describe(p);
    p.integer("Budget [1]", budget, non_negative,
              "Pairs that are looked at in a step, at most; the rest waits, first come first served. 0: all at once.");
  }
};

struct PhyxelsOptions {
  pba::PhyxelOptions phyxels;
  pba::ModelOptions model;
  material::Elastic material;
  VisibilityOptions visibility;
};

class Phyxels : public Physics {
 public:
  /// Fills the body. Throws as pba::fill().
  Phyxels(const CutBody& body, const PhyxelsOptions& options, StepperMaker make_stepper);

  pba::PhyxelModel& model() override { return model_; }
  const Points& rest() const override { return model_.phyxels().rest; }
  bool particles_are_corners() const override { return false; }
  const Crumbs& crumbs() const override { return crumbs_; }
  dynamics::MotionKind motion() const override { return stepper_->motion(); }
  dynamics::StepReport step(dynamics::State& state, const dynamics::Loads& loads, double dt) override;
  void follow_cut(const CutBody& body, const grid::CutChange& change, dynamics::State& state) override;
  void let_out(const CutBody& body, const grid::CutChange& change, const EnergyBefore& had,
               const dynamics::Loads& loads, dynamics::State& state) override;
  bool catch_up(const CutBody& body) override;
  void archive(Archive& a, const CutBody& body) override;
  void follow(const dynamics::State& state) override;
  const Points& corners(const dynamics::State&) const override { return corners_; }
  /// Point by point the weights of (2.33), corrected to first order: so forces keep their torque where three phyxels
  /// and more are in sight that are not in a row.
  Interpolation carry(const Interpolation& of_corners) const override;

  const dynamics::Stepper& stepper() const { return *stepper_; }
  const pba::CornerMap& map() const { return map_; }
  /// Pairs that wait to be looked at.
  std::size_t n_waiting() const { return sights_ ? sights_->n_waiting() : 0; }

 private:
  using Face = visibility::Face;
  struct Made {
    pba::PhyxelModel model;
    pba::NodePairs node_pairs;
  };

  static Made make(const CutBody& body, const PhyxelsOptions& options);
  Phyxels(const CutBody& body, const PhyxelsOptions& options, StepperMaker make_stepper, Made made);

  void begin_to_look(const CutBody& body);
  /// Those that are new come between the pairs.
  void add_faces(const std::vector<Face>& faces);
  void find_pieces(const CutBody& body);
  void find_touched(const std::vector<double>& weights_before);
  /// Between parts of a piece that no bond joins.
  std::vector<pba::Link> missing_links(const CutBody& body) const;
  void build_map(const CutBody& body);
  /// Leaves no sight to phyxels that crumbs carry.
  void leave_out_crumbs(const std::vector<pba::Pair>& pairs, std::vector<pba::Sight>& sights) const;
  void follow_crumbs(const CutBody& body, const std::function<Motion()>& motion_of_corners, dynamics::State& state);
  /// Weights of phyxels for a point [m] that moves with a row of the map, times `factor`.
  void add_row(std::uint32_t row, const Vec3& point, double factor, std::vector<std::uint32_t>& phyxels,
               std::vector<double>& weights) const;

  struct ByCoordinates {
    bool operator()(const Face& a, const Face& b) const;
  };

  PhyxelsOptions options_;
  StepperMaker make_stepper_;
  pba::PhyxelModel model_;
  std::unique_ptr<dynamics::Stepper> stepper_;

  pba::NodePairs node_pairs_;
  std::vector<pba::Sight> sights_of_phyxels_, sights_of_nodes_; ///< of each pair, as the criterion sees it
  std::vector<std::uint32_t> phyxel_pieces_, node_pieces_;      ///< none before the first cut
  std::vector<grid::CopyId> copies_;                            ///< of each phyxel
  pba::CornerMap map_;
  bool is_stale_ = false; ///< sights or pieces are newer than model and map
  std::vector<std::uint8_t> touched_; ///< 1 for each phyxel that sees another one otherwise since follow_cut()

  std::optional<visibility::PairSights> sights_;
  std::set<Face, ByCoordinates> faces_;

  Crumbs crumbs_;
  Points now_; ///< where the phyxels were when follow() was called last [m]
  std::vector<Mat3> F_;
  Points corners_;
};

} // namespace kerf::physics
