#include "visibility/pair_sights.h"

#include "base/parallel.h"
#include "tests/visibility/cases.h"
#include "visibility/cpu_rasteriser.h"
#include "visibility/extended.h"

#include <gtest/gtest.h>

namespace kerf::visibility::pair_sights_test {
namespace {

struct Crowd {
  std::vector<Pair> pairs;
  std::vector<Face> faces;
};

Crowd crowd(const unsigned seed, const int n_pairs, const int n_faces) {
  Random random(seed);
  Crowd found;
  for (int i = 0; i < n_pairs; ++i) {
    const Vec3 a = random.vector();
    found.pairs.push_back({a, a + 0.3 * random.direction(), 0.6});
  }
  for (int i = 0; i < n_faces; ++i) {
    const Vec3 middle = random.vector();
    Face face;
    for (Vec3& corner : face)
      corner = middle + 0.2 * random.vector();
    found.faces.push_back(face);
  }
  return found;
}

PairSights make(const std::string& name) {
  CriterionChoice choice;
  choice.criterion = name;
  return PairSights(make_criterion(choice));
}

void finish(PairSights& sights, const std::size_t budget) {
  while (sights.update(budget).n_waiting > 0) {
  }
}

/// Adds the faces in batches, with an update of `budget` pairs after each, and what is left at the end.
Sights grown(const std::string& name, const Crowd& crowd, const std::size_t batch, const std::size_t budget) {
  PairSights sights = make(name);
  sights.watch(PairId(0), crowd.pairs);
  for (std::size_t i = 0; i < crowd.faces.size(); i += batch) {
    sights.add_faces(std::span(crowd.faces).subspan(i, std::min(batch, crowd.faces.size() - i)));
    sights.update(budget);
  }
  finish(sights, budget);
  return sights.sights();
}

int n_changed(const Sights& sights, const std::vector<Pair>& pairs) {
  int n = 0;
  for (const auto id : ids<PairId>(sights.size()))
    n += sights[id] != pba::Sight{(pairs[id.value].b - pairs[id.value].a).norm(), 1};
  return n;
}

TEST(PairSights, SearchFindsAllThatAnExhaustiveOneFinds) {
  const Crowd c = crowd(1, 300, 200);
  const MaskShape shape(32, 0.5);
  const Sights sights = grown("extended visibility", c, 7, 50);
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < c.faces.size(); ++i)
    all.push_back(i);
  for (const auto id : ids<PairId>(c.pairs.size())) {
    std::vector<std::uint32_t> mask(32, 0);
    const DiskUpdate update{make_disk(c.pairs[id.value], shape), all, mask.data()};
    CpuRasteriser().occlude(shape, c.faces, {&update, 1});
    EXPECT_EQ(sights[id].factor, (shape.n_texels() - count(mask)) / double(shape.n_texels()));
  }
  EXPECT_GT(n_changed(sights, c.pairs), 100);
}

/// A pair that is given up as cut off stays so; the others end up the same whatever came first.
TEST(PairSights, EndDoesNotDependOnBudgetOrBatches) {
  const Crowd c = crowd(2, 200, 150);
  for (const std::string& name : criteria()) {
    const Sights once = grown(name, c, 1000, 1000);
    EXPECT_GT(n_changed(once, c.pairs), 10);
    for (const auto& [batch, budget] : {std::pair<std::size_t, std::size_t>{10, 1000}, {10, 7}, {40, 3}}) {
      const Sights other = grown(name, c, batch, budget);
      for (const auto id : ids<PairId>(once.size()))
        if (other[id].factor > 0) {
          EXPECT_EQ(once[id], other[id]) << name;
        } else if (name == "visibility" || name == "extended visibility") {
          EXPECT_EQ(once[id].factor, 0) << name;
        }
    }
  }
}

TEST(PairSights, WeightsNeverGrow) {
  const Crowd c = crowd(3, 200, 100);
  PairSights sights = make("extended visibility");
  sights.watch(PairId(0), c.pairs);
  Sights before = sights.sights();
  for (const Face& face : c.faces) {
    sights.add_faces({&face, 1});
    sights.update(1000);
    for (const auto id : ids<PairId>(before.size()))
      EXPECT_LE(sights.sights()[id].factor, before[id].factor);
    before = sights.sights();
  }
}

TEST(PairSights, TwoThreadsGiveTheSameBits) {
  const Crowd c = crowd(4, 500, 200);
  const int n = n_threads();
  for (const std::string& name : criteria()) {
    set_n_threads(1);
    const Sights one = grown(name, c, 20, 300);
    set_n_threads(2);
    const Sights two = grown(name, c, 20, 300);
    EXPECT_EQ(one.items(), two.items()) << name;
  }
  set_n_threads(n);
}

/// Two pairs in two places; each face crosses one of them.
struct Places {
  PairSights sights = make("visibility");
  std::vector<Face> faces;

  explicit Places(const int n) {
    std::vector<Pair> pairs;
    for (int i = 0; i < n; ++i) {
      const Vec3 p(i, 0, 0);
      pairs.push_back({p - Vec3(0, 0, 0.3), p + Vec3(0, 0, 0.3), 1});
      faces.push_back({p + Vec3(-0.2, -0.2, 0.01), p + Vec3(0.2, -0.2, 0.01), p + Vec3(0, 0.2, 0.01)});
    }
    sights.watch(PairId(0), pairs);
  }
  void cut(const int i) { sights.add_faces({&faces[i], 1}); }
};

TEST(PairSights, FirstComeFirstServed) {
  Places places(6);
  for (const int i : {4, 1, 5, 1, 0})
    places.cut(i);
  EXPECT_EQ(places.sights.n_waiting(), 4u);
  const Progress first = places.sights.update(2);
  EXPECT_EQ(first.changed, (std::vector{PairId(4), PairId(1)}));
  EXPECT_EQ(first.n_done, 2u);
  EXPECT_EQ(first.n_waiting, 2u);
  EXPECT_EQ(places.sights.sights()[PairId(5)].factor, 1); // its turn has not come
  places.cut(2);
  places.cut(4); // is cut off already: nothing to look at
  const Progress second = places.sights.update(9);
  EXPECT_EQ(second.changed, (std::vector{PairId(5), PairId(0), PairId(2)}));
  EXPECT_EQ(second.n_done, 3u);
  EXPECT_EQ(second.n_waiting, 0u);
  EXPECT_EQ(places.sights.update(9).n_done, 0u);
  EXPECT_EQ(places.sights.update(0).n_done, 0u);
  EXPECT_EQ(places.sights.sights()[PairId(3)].factor, 1);
}

TEST(PairSights, ThoseThatComeTogetherGoByNumber) {
  Places places(6);
  const std::vector<Face> faces = {places.faces[5], places.faces[2], places.faces[3]};
  places.sights.add_faces(faces);
  EXPECT_EQ(places.sights.update(9).changed, (std::vector{PairId(2), PairId(3), PairId(5)}));
}

TEST(PairSights, NewPairsSeeTheCutThatIsThere) {
  const Crowd c = crowd(5, 200, 100);
  for (const std::string& name : criteria()) {
    PairSights sights = make(name);
    const std::span<const Face> faces = c.faces;
    sights.add_faces(faces.first(40));
    sights.watch(PairId(0), std::span(c.pairs).first(50));
    finish(sights, 20);
    sights.add_faces(faces.subspan(40, 20));
    sights.watch(PairId(50), std::span(c.pairs).subspan(50));
    sights.add_faces(faces.subspan(60));
    finish(sights, 20);
    EXPECT_EQ(sights.sights().items(), grown(name, c, 1000, 1000).items()) << name;
  }
}

/// Other points take the place of a pair, even while it waits.
TEST(PairSights, PairsCanChange) {
  const Crowd c = crowd(6, 200, 100), other = crowd(7, 200, 100);
  for (const std::string& name : criteria()) {
    PairSights sights = make(name);
    sights.watch(PairId(0), other.pairs);
    sights.add_faces(c.faces);
    sights.update(3);
    sights.watch(PairId(0), c.pairs);
    finish(sights, 20);
    EXPECT_EQ(sights.sights().items(), grown(name, c, 1000, 1000).items()) << name;
  }
}

} // namespace
} // namespace kerf::visibility::pair_sights_test
