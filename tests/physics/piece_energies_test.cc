/// Elastic energy, told apart by pieces.

#include "dynamics/piece_gains.h"
#include "fem/hexahedra.h"
#include "spring/mass_spring.h"
#include "tests/fem/models.h"

#include <gtest/gtest.h>

#include <numeric>

namespace kerf::piece_energies_test {
namespace {

/// Each has what the energy of the whole changes by where it alone is deformed; together they have all.
template <class Model>
void check(const Model& model, const fem::Body& body, const unsigned seed) {
  const dynamics::Pieces pieces(grid::corner_pieces(body.complex));
  ASSERT_GT(pieces.n(), 3u);
  const Points rest = body.rest();
  fem::Draw draw(seed);
  Points x = rest;
  for (Vec3& p : x)
    p += 0.03 * draw.vector();
  const Loan<double> energies = model.energies(x, pieces);
  const double all = model.energy(x);
  EXPECT_NEAR(std::accumulate(energies->begin(), energies->end(), 0.0), all, 1e-12 * all);
  for (std::uint32_t piece = 0; piece < pieces.n(); ++piece) {
    Points alone = rest;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (pieces.of(i) == piece)
        alone[i] = x[i];
    EXPECT_NEAR(energies[piece], model.energy(alone), 1e-9 * all) << piece;
  }
}

fem::Body pieces_of_block(const unsigned seed) {
  fem::Draw draw(seed);
  fem::Body body = fem::make_block({5, 4, 3}, 0.2, draw, {0.05, 0.95});
  fem::cut_at_random(body, 0.7, draw, {0.05, 0.95});
  return body;
}

TEST(PieceEnergies, OfElementsOfAllLaws) {
  const fem::Body body = pieces_of_block(1);
  for (const std::string& law : fem::all_laws)
    for (const fem::Strain strain : fem::all_strains) {
      SCOPED_TRACE(law);
      check(fem::Hexahedra(body, {.material = fem::with_law({}, law), .strain = strain}), body, 2);
    }
}

TEST(PieceEnergies, OfSprings) {
  const fem::Body body = pieces_of_block(3);
  check(spring::MassSpring(body, {}), body, 4);
}

} // namespace
} // namespace kerf::piece_energies_test
