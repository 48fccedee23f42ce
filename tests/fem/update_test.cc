/// A model that follows cuts is the model that is built anew, bit by bit.

#include "base/parallel.h"
#include "cut/cutter.h"
#include "dynamics/state.h"
#include "tests/fem/models.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

namespace kerf::fem::update_test {
namespace {

const material::Elastic rubber{.density = 1000, .youngs_modulus = 2e3, .poissons_ratio = 0.4};

/// Everything a model says at a state.
std::vector<double> answers(Hexahedra& model, const Points& x) {
  std::vector<double> all = {model.energy(x), model.volume(), static_cast<double>(model.n_partial())};
  const auto add = [&](const std::span<const double> values) { all.insert(all.end(), values.begin(), values.end()); };
  Points f, y(x.size());
  model.force(x, f);
  model.linearise(x);
  model.apply_stiffness(dynamics::flat(x), dynamics::flat(y));
  const std::vector<Mat3> blocks = dynamics::stiffness_blocks(model);
  add(model.lumped_mass());
  add(dynamics::flat(f));
  add(dynamics::flat(y));
  for (const Mat3& block : blocks)
    add({block.data(), 9});
  return all;
}

/// What its multigrid makes of r, at the state that it was linearised at.
Points by_multigrid(Hexahedra& model, const Points& r) {
  const dynamics::Loads loads;
  const dynamics::Constraints constraints(loads, r.size());
  dynamics::Preconditioner* const own = model.preconditioner({1, 1, model.lumped_mass(), 1e9, {}, constraints});
  if (!own)
    throw std::logic_error("there is no multigrid");
  Points z(r.size());
  own->apply(dynamics::flat(r), dynamics::flat(z));
  return z;
}

Points disturbed(const Body& body, Draw& draw) {
  Points x = body.rest();
  for (Vec3& p : x)
    p += 0.02 * draw.vector();
  return x;
}

/// Cuts some inner edges, and brings the complex up to date. Returns the copies whose element is another now.
std::vector<grid::CopyId> cut_some(Body& body, const double probability, Draw& draw) {
  std::vector<grid::EdgeId> edges;
  for (const auto e : inner_edges(body))
    if (draw(0, 1) < probability) {
      body.cuts.add(body.grid, {e, draw(0.1, 0.9), draw.vector().normalized(), 1});
      edges.push_back(e);
    }
  surface::place(body, {});
  return grid::update_complex(body, edges).reshaped;
}

TEST(Update, IsBuildingAnewBitByBit) {
  for (const Boundary boundary : {Boundary::octants, Boundary::volume_fraction, Boundary::full_cube})
    for (const auto& [law, inertia] :
         {std::pair(all_laws[1], Inertia::extended), std::pair(all_laws[3], Inertia::lumped)}) {
      Draw draw(90);
      Body body = make_block({3, 3, 3}, 0.2, draw, {0.3, 0.7});
      const HexahedraOptions options{
        .material = with_law(rubber, law), .boundary = boundary, .strain = Strain::enhanced, .inertia = inertia};
      Hexahedra model = make_model(body, options);
      for (int step = 0; step < 6; ++step) {
        const auto changed = cut_some(body, 0.08, draw);
        model.update(body, changed);
        const Points x = disturbed(body, draw);
        Hexahedra anew = make_model(body, options);
        ASSERT_EQ(answers(model, x), answers(anew, x)) << law << ", step " << step;
      }
      EXPECT_GT(body.complex.n_copies(), 64u);
    }
}

/// A front that moves on, by masses that tied corners share and ties that explicit steps bear; and multigrid on it.
TEST(Update, OfAFrontIsBuildingAnewBitByBit) {
  Draw draw(91);
  Body body = make_block({6, 6, 6}, 0.2, draw, {0.3, 0.7});
  cut::Cutter cutter(1, cut::Release::queued, cut::Fronts::of_elements);
  cutter.begin(body, body.rest());
  const HexahedraOptions options{.material = rubber, .strain = Strain::enhanced, .inertia = Inertia::extended};
  Hexahedra model = make_model(body, options);
  std::size_t n_tied = 0;
  for (double radius = 0.2; radius < 0.6; radius += 0.017) {
    const cut::Disc disc{Vec3(0.53, 0.48, 0.51), Vec3(0.1, 0.2, 1).normalized(), radius};
    grid::CutChange change = cutter.at_once(body, {"disc", disc, 1}, body.rest());
    surface::place(body, change, {});
    model.update(body, change.reshaped);
    const Points x = disturbed(body, draw);
    Hexahedra anew = make_model(body, options);
    ASSERT_EQ(answers(model, x), answers(anew, x)) << radius;
    ASSERT_EQ(by_multigrid(model, body.rest()), by_multigrid(anew, body.rest())) << radius;
    n_tied += body.complex.tied.size();
  }
  EXPECT_GT(n_tied, 200u);
}

/// Whether somebody has asked for the diagonal of the stiffness or nobody has, before a cut, after one and after two:
/// multigrid does the same as that of a new model, bit by bit.
TEST(Update, SharesADiagonalThatIsThere) {
  for (const std::string& law : all_laws) {
    Draw draw(310);
    Body body = make_block({9, 9, 9}, 0.1, draw, {0.01, 0.99});
    const HexahedraOptions options{.material = with_law(rubber, law)};
    Hexahedra model = make_model(body, options);
    for (int step = 0; step < 4; ++step) {
      const Points x = disturbed(body, draw), r = body.rest();
        const auto applied = [&](Hexahedra& to, const int n_asked) {
        to.linearise(x);
        for (int k = 0; k < n_asked; ++k)
          EXPECT_GT(dynamics::stiffness_blocks(to)[0].trace(), 0);
        return by_multigrid(to, r);
      };
      Hexahedra anew = make_model(body, options);
      const Points alone = applied(anew, 0);
      for (const int n_asked : {1, 0, 2, 1})
        EXPECT_EQ(applied(model, n_asked), alone) << law << ", step " << step;
      model.update(body, cut_some(body, 0.03, draw));
      if (step == 1) { // asked for between two cuts, by nobody who has a use for multigrid
        model.linearise(disturbed(body, draw));
        EXPECT_GT(dynamics::stiffness_blocks(model)[0].trace(), 0);
        model.update(body, cut_some(body, 0.03, draw));
      }
    }
  }
}

/// What a model remembers of the positions that it met last is what it would say anew, in any order, and nothing is
/// remembered across a cut.
TEST(Update, RemembersNothingButTheSame) {
  int n_changed = 0; // laws with which the cut changes the energy, by round-off
  for (const std::string& law : all_laws) {
    Draw draw(95);
    Body body = make_block({3, 3, 3}, 0.2, draw, {0.3, 0.7});
    const HexahedraOptions options{.material = with_law(rubber, law)};
    Hexahedra model = make_model(body, options);
    const Points x = disturbed(body, draw), other = disturbed(body, draw);
    Points f, f_alone;
    make_model(body, options).force(x, f_alone);
    const double alone = make_model(body, options).energy(x);
    EXPECT_EQ(model.energy_ahead(x), alone) << law;
    model.force(x, f);
    EXPECT_EQ(f, f_alone) << law;
    model.force(other, f);
    EXPECT_EQ(model.energy(x), alone) << law;
    model.force(x, f);
    EXPECT_EQ(model.energy_ahead(x), alone) << law;
    EXPECT_EQ(f, f_alone) << law;
    const auto edge = inner_edges(body)[0];
    body.cuts.add(body.grid, {edge, 0.4, Vec3::UnitX(), 1});
    surface::place(body, {});
    model.update(body, grid::update_complex(body, {edge}).reshaped);
    ASSERT_EQ(body.complex.n_corners(), x.size()); // nothing but the model can tell that there was a cut
    EXPECT_EQ(model.energy_ahead(x), make_model(body, options).energy(x)) << law;
    n_changed += model.energy(x) != alone ? 1 : 0;
  }
  EXPECT_GT(n_changed, 0);
}

/// Forces that are known are brought up to date where a cut is, and are those of a model that is built anew; also when
/// the cut comes before they are asked for again, or the body has moved since, or crumbs are not counted.
TEST(Update, OfKnownForcesIsFindingThemAnew) {
  for (const auto& [law, counted] :
       {std::pair(all_laws[1], grid::Counted::all), std::pair(all_laws[3], grid::Counted::all),
        std::pair(all_laws[1], grid::Counted::deforming)}) {
    Draw draw(97);
    Body body = make_block({40, 14, 9}, 0.1, draw, {0.3, 0.7});
    const HexahedraOptions options{.material = with_law(rubber, law), .counted = counted};
    Hexahedra model = make_model(body, options);
    Points all = disturbed(body, draw), x = all, f, f_anew;
    const std::size_t n_corners = x.size();
    std::size_t n_beside_crumbs = 0;
    model.energy_ahead(x);
    for (int step = 0; step < 24; ++step) {
      const Vec3 centre(0.5 + 0.15 * step, 0.1 + 0.04 * step, 0.3 + 0.025 * step);
      std::vector<grid::EdgeId> edges;
      for (const auto e : inner_edges(body))
        if ((body.grid.position(body.grid.ends(e)[0]) - centre).norm() < 0.2 && draw(0, 1) < 0.3) {
          body.cuts.add(body.grid, {e, draw(0.1, 0.9), draw.vector().normalized(), 1});
          edges.push_back(e);
        }
      surface::place(body, {});
      grid::CutChange change = grid::update_complex(body, edges);
      if (counted == grid::Counted::deforming)
        grid::update_crumbs(body, change, nullptr);
      const grid::CornerNumbers before = model.numbers();
      model.update(body, change.reshaped);
      n_beside_crumbs += !before.are_all() && model.numbers().extend(before) ? 1 : 0;
      grid::inherit(change, all);
      if (step % 4 == 1)
        continue;
      if (step % 4 == 3)
        all[0] += 0.01 * draw.vector();
      model.numbers().gather(all, x);
      const Hexahedra anew = make_model(body, options);
      const double energy = step % 2 == 0 ? model.energy_ahead(x) : anew.energy(x);
      model.force(x, f);
      anew.force(x, f_anew);
      EXPECT_EQ(energy, anew.energy(x)) << law << ", step " << step;
      EXPECT_EQ(model.energy(x), anew.energy(x)) << law << ", step " << step;
      ASSERT_EQ(f, f_anew) << law << ", step " << step;
    }
    EXPECT_GT(all.size(), n_corners + 50) << law;
    if (counted == grid::Counted::deforming) {
      EXPECT_GT(n_beside_crumbs, 3u);
    }
  }
}

/// Whatever corners the copies get, in whatever order they come, and crumb or not: who holds a corner is listed in the
/// same order.
TEST(Update, IncidenceIsThatOfTheComplexAfterAnyChange) {
  Draw draw(94);
  const grid::Grid grid({Vec3::Zero(), 1}, std::vector<Index3>(1, Index3{1, 1, 1}));
  grid::Solid solid{grid, grid::Cuts(grid)};
  grid::CellComplex& complex = solid.complex;
  complex.node.resize(40);
  const auto any_corner = [&] { return grid::CornerId(static_cast<std::size_t>(draw(0, 40))); };
  for (int c = 0; c < 20; ++c) {
    complex.copies.push_back({});
    for (auto& corner : complex.copies[grid::CopyId(std::size_t(c))].corners)
      corner = any_corner();
  }
  solid.crumbs.of_copy.assign(20, 0);
  Incidence incidence(solid);
  for (int step = 0; step < 50; ++step) {
    std::vector<grid::CopyId> changed;
    for (int i = 0; i < 3; ++i)
      changed.emplace_back(static_cast<std::size_t>(draw(0, 20)));
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    for (const auto c : changed)
      complex.copies[c].corners[static_cast<int>(draw(0, 8))] = any_corner();
    solid.crumbs.of_copy[changed[0].value] = draw(0, 1) < 0.5 ? 1 : 0;
    incidence.update(solid, changed);
    const Incidence anew(solid);
    for (std::size_t corner = 0; corner < 40; ++corner)
      ASSERT_TRUE(std::ranges::equal(incidence.users(corner), anew.users(corner))) << step;
  }
}

/// A small cut in a large body changes the elements of its cells alone.
TEST(Update, ChangesFewElements) {
  Draw draw(93);
  Body body = make_block({8, 8, 8}, 0.1, draw, {0.5, 0.5});
  const auto edge = inner_edges(body)[100];
  body.cuts.add(body.grid, {edge, 0.5, Vec3::UnitX(), 1});
  const auto change = grid::update_complex(body, {edge});
  EXPECT_EQ(change.reshaped.size(), 4u);
}

/// Elements of their own are those of partial copies, and are no more when all are remade.
TEST(Update, CountsElementsOfTheirOwn) {
  Draw draw(91);
  Body body = make_block({4, 4, 4}, 0.2, draw, {0.5, 0.5});
  Hexahedra model = make_model(body, {.material = rubber});
  const std::size_t before = model.n_partial();
  std::vector<grid::CopyId> all;
  for (const auto c : ids<grid::CopyId>(body.complex.n_copies()))
    all.push_back(c);
  model.update(body, all);
  EXPECT_EQ(model.n_partial(), before);
  EXPECT_EQ(before, 125u - 27u);
}

/// Functions that leave a model as it is may be called at the same time.
TEST(Update, ConstantFunctionsMayRunAtOnce) {
  Draw draw(92);
  Body body = make_block({4, 4, 4}, 0.2, draw, {0.3, 0.7});
  const Hexahedra model = make_model(body, {.material = with_law(rubber, "neo-Hookean")});
  const Points x = disturbed(body, draw);
  Points expected;
  model.force(x, expected);
  std::vector<int> n_wrong(4, 0);
  std::vector<std::thread> threads;
  for (int& wrong : n_wrong)
    threads.emplace_back([&] {
      Points f, y(x.size());
      for (int i = 0; i < 50; ++i) {
        model.apply_stiffness(dynamics::flat(x), dynamics::flat(y));
        model.force(x, f);
        wrong += f != expected;
      }
    });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(n_wrong, std::vector<int>(4, 0));
}

} // namespace
} // namespace kerf::fem::update_test
