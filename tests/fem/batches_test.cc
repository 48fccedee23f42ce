#include "fem/batches.h"

#include "tests/support/threads.h"

#include <deal.II/base/multithread_info.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <random>

namespace kerf::fem::batches_test {
namespace {

/// A row of cubes in three chunks, every third of them partial, and what they are made of.
struct RowOfCubes {
  static constexpr std::uint32_t per_chunk = 100;
  std::vector<std::uint32_t> order, chunk_ends, corners;
  std::vector<Kind> kinds;
  std::vector<Element> elements;
  std::size_t n_corners;

  RowOfCubes() : order(3 * per_chunk), n_corners(4 * (order.size() + 1)) {
    std::iota(order.begin(), order.end(), 0);
    for (const std::uint32_t c : order) {
      kinds.push_back(c % 3 == 0 ? Kind::partial : Kind::full);
      elements.emplace_back();
      elements.back().volume = c;
      for (std::uint32_t a = 0; a < 8; ++a)
        corners.push_back(4 * (c + a % 2) + a / 2);
    }
    chunk_ends = {per_chunk, 2 * per_chunk, 3 * per_chunk};
  }
  /// Another copy in the second chunk's last cell, with corners of its own.
  void split() {
    const auto last = static_cast<std::uint32_t>(kinds.size());
    order.insert(order.begin() + chunk_ends[1], last);
    ++chunk_ends[1];
    ++chunk_ends[2];
    kinds.push_back(Kind::partial);
    elements.emplace_back();
    elements.back().volume = 1000;
    for (std::uint32_t a = 0; a < 8; ++a)
      corners.push_back(static_cast<std::uint32_t>(n_corners) + a);
    n_corners += 8;
  }
  CopiesInOrder copies() const { return {order, chunk_ends, kinds, corners.data(), n_corners}; }
  PartialElements partial() const {
    return {[this](const std::uint32_t copy) -> const Element& { return elements[copy]; }};
  }
};

/// The places of what the batches of a chunk are made of.
std::vector<std::uint32_t> places(const Batching& batching, const std::uint32_t first_copy,
                                  const std::uint32_t last_copy) {
  std::vector<std::uint32_t> all;
  for (const BatchOfCopies& batch : batching.batches())
    if (batch.partial != BatchOfCopies::none && batch.copies[0] >= first_copy && batch.copies[0] < last_copy)
      all.push_back(batch.partial);
  return all;
}

/// A copy more, and a partial cube that becomes full: of that chunk alone is anything made anew, and all lanes hold
/// their elements, those beside too.
TEST(Batches, OfOtherChunksStayWhereTheyAre) {
  const material::Elastic material{.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3};
  RowOfCubes row;
  Batching batching(row.copies());
  BatchedElements<double> batched = fem::batched<double>(batching, 0.1, material, {}, row.partial());
  const auto first = places(batching, 0, 100), third = places(batching, 200, 300);
  ASSERT_EQ(first.size(), 3u); // 34 partial cubes
  const std::size_t n_rows = batching.n_rows();
  row.split();
  row.kinds[102] = Kind::full;
  std::vector<std::uint8_t> is_same(row.kinds.size(), 1);
  is_same[102] = is_same[300] = 0;
  std::vector<std::uint8_t> is_met = {0, 1, 0};
  std::vector<std::uint32_t> renewed = batching.update(row.copies(), is_same, is_met).renewed;
  for (const std::uint32_t i : renewed)
    for (const std::uint32_t copy : batching.batches()[i].copies)
      EXPECT_TRUE(copy == BatchOfCopies::none || (copy >= 100 && copy < 200) || copy == 300) << copy;
  EXPECT_EQ(renewed.size(), 3u);
  EXPECT_EQ(places(batching, 0, 100), first);
  EXPECT_EQ(places(batching, 200, 300), third);
  EXPECT_EQ(batching.n_places(), 9u); // those of the second chunk are taken again
  EXPECT_EQ(batching.n_rows(), n_rows + 8);
  // A change of material alone.
  is_same.assign(row.kinds.size(), 1);
  is_same[0] = 0;
  row.elements[0].volume = 2000;
  fem::follow(batching, renewed, row.partial(), batched);
  is_met = {1, 0, 0};
  renewed = batching.update(row.copies(), is_same, is_met).renewed;
  ASSERT_EQ(renewed.size(), 1u);
  EXPECT_EQ(batching.batches()[renewed[0]].copies[0], 0u);
  fem::follow(batching, renewed, row.partial(), batched);
  std::size_t n = 0;
  for (const BatchOfCopies& batch : batching.batches())
    for (std::size_t lane = 0; batch.partial != BatchOfCopies::none && lane < n_lanes; ++lane)
      if (const std::uint32_t copy = batch.copies[lane]; copy != BatchOfCopies::none) {
        EXPECT_EQ(batched.partial[batch.partial].volume[lane], row.elements[copy].volume) << copy;
        ++n;
      }
  EXPECT_EQ(n, 100u);
  for (const BatchOfCopies& batch : batching.batches()) // lanes that are not used have rows of their own
    for (std::size_t lane = 0; lane < n_lanes; ++lane)
      EXPECT_EQ(batch.corners[0][lane] >= row.n_corners, batch.copies[lane] == BatchOfCopies::none);
}

/// After any changes the batches are those of copies that come anew; all that a cut has not met is taken over.
TEST(Batches, AreThoseThatAreMadeAnew) {
  RowOfCubes row;
  Batching batching(row.copies());
  const auto expect_as_anew = [&] {
    const Batching anew(row.copies());
    ASSERT_EQ(batching.batches().size(), anew.batches().size());
    for (std::size_t i = 0; i < anew.batches().size(); ++i) {
      const BatchOfCopies &a = batching.batches()[i], &b = anew.batches()[i];
      EXPECT_TRUE(std::ranges::equal(a.copies, b.copies)) << i;
      EXPECT_EQ(a.partial == BatchOfCopies::none, b.partial == BatchOfCopies::none) << i;
      for (std::size_t v = 0; v < 8; ++v)
        EXPECT_TRUE(std::ranges::equal(a.corners[v], b.corners[v])) << i;
    }
  };
  row.split(); // and all lanes that are not used have another row, in the other chunks too
  row.kinds[102] = Kind::full;
  std::vector<std::uint8_t> is_same(row.kinds.size(), 1);
  is_same[102] = is_same[300] = 0;
  batching.update(row.copies(), is_same, std::vector<std::uint8_t>{0, 1, 0});
  expect_as_anew();
  is_same.assign(row.kinds.size(), 1);
  for (std::uint32_t& corner : row.corners)
    ++corner;
  ++row.n_corners;
  batching.update(row.copies(), is_same, {}, CornersOfSame::renumbered);
  expect_as_anew();
}

/// Full cubes side by side along x go through the kernels as a row; the other way round they do not, and have the same
/// product.
TEST(Batches, OfCubesInARowHaveTheSameProduct) {
  constexpr std::uint32_t n = 40;
  const material::Elastic material{.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3};
  const Element full = make_element(full_cube_moments(), 0.1, material, {});
  RowOfCubes row;
  row.kinds.assign(row.kinds.size(), Kind::full);
  row.order.resize(n);
  row.chunk_ends = {n};
  std::vector<Row<double>> products[2];
  for (auto& y : products) {
    const Batching batching(row.copies());
    EXPECT_EQ(batching.batches()[0].is_row, &y == products);
    const auto elements = batched<double>(batching, 0.1, material, full, {});
    std::vector<Row<double>> p(batching.n_rows());
    for (std::uint32_t i = 0; i < 4 * (n + 1); ++i)
      p[i] = {double(i * i % 17), double(i * 7 % 13), double(i * 5 % 11)};
    y.resize(p.size());
    add_product(batching, elements, p.data(), y.data());
    std::ranges::reverse(row.order);
  }
  for (std::size_t i = 0; i < 4 * (n + 1); ++i) {
    EXPECT_NEAR(products[0][i].x, products[1][i].x, 1e-7) << i;
    EXPECT_NEAR(products[0][i].y, products[1][i].y, 1e-7) << i;
    EXPECT_NEAR(products[0][i].z, products[1][i].z, 1e-7) << i;
  }
}

/// Its element, and what products read of it in both precisions.
TEST(Batches, OfAPartialCellAreAKilobyte) {
  const std::size_t of_lanes = sizeof(PartialCubes<double>) + sizeof(PartialCubes<float>) + sizeof(HourglassOfCubes);
  EXPECT_LE(sizeof(Element) + of_lanes / n_lanes, 1024u);
  const BatchedElements<double> model = batched<double>({}, 0.1, {}, {}, {});
  EXPECT_EQ(batched<float>({}, 0.1, {}, {}, {}, model.shared).shared.hourglass, model.shared.hourglass);
}

/// The preconditioner's elements turn with the model's, and do not take their rotations away.
TEST(Batches, RotationsAreKeptOnce) {
  const material::Elastic material{.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3};
  const Element full = make_element(full_cube_moments(), 0.1, material, {});
  const std::vector<std::uint32_t> order = {0}, ends = {1}, corners = {0, 1, 2, 3, 4, 5, 6, 7};
  const std::vector<Kind> kinds = {Kind::full};
  const Batching batching({order, ends, kinds, corners.data(), 8});
  const BatchedElements<double> model = batched<double>(batching, 0.1, material, full, {});
  ASSERT_EQ(model.shared.rotations->size(), 1u);
  float& first = (*model.shared.rotations)[0].row[0][0];
  EXPECT_EQ(first, 1);
  first = 0.5;
  const BatchedElements<float> other = batched<float>(batching, 0.1, material, full, {}, model.shared);
  EXPECT_EQ(other.shared.rotations, model.shared.rotations);
  EXPECT_EQ(first, 0.5);
}

/// Chunks of random sizes in a block of cubes, some of them without use, by four threads: no two batches that share a
/// corner are at work at once, nor two whose cubes lie in one cube twice as large, and each corner meets its batches in
/// the order in which one thread calls them.
TEST(Batches, ThatShareACornerKeepTheirOrder) {
  constexpr std::uint32_t n = 24, m = n + 1;
  std::vector<std::uint32_t> order(n * n * n), corners, chunk_ends;
  std::vector<Kind> kinds;
  std::mt19937 random(12);
  std::iota(order.begin(), order.end(), 0);
  for (const std::uint32_t c : order) {
    const std::uint32_t x = c % n, y = c / n % n, z = c / (n * n);
    for (std::uint32_t a = 0; a < 8; ++a)
      corners.push_back(x + a % 2 + m * (y + a / 2 % 2 + m * (z + a / 4)));
    kinds.push_back(random() % 10 == 0 ? Kind::unused : random() % 3 == 0 ? Kind::partial : Kind::full);
  }
  for (std::uint32_t end = 0; end < order.size();)
    chunk_ends.push_back(end = std::min<std::uint32_t>(end + 1 + random() % 60, n * n * n));
  const OrderOfChunks of_cells = order_of_chunks(chunk_ends, corners, m * m * m);
  EXPECT_GT(of_cells.shared.width(), 2);
  EXPECT_LT(2 * of_cells.runs.size(), chunk_ends.size());
  Batching batching(of_cells);
  batching.update({order, chunk_ends, kinds, corners.data(), m * m * m}, {}, {});
  const auto coarse = [](const std::uint32_t c) { return c % n / 2 + n * (c / n % n / 2 + n * (c / (n * n) / 2)); };

  using Sequences = std::vector<std::vector<std::size_t>>; // of batches, by corner
  std::vector<std::atomic<std::uint32_t>> users(m * m * m), users_of_coarse(n * n * n);
  std::atomic<int> n_met = 0;
  const auto sequences = [&](const int n_threads) {
    Sequences all(m * m * m);
    const auto note = [&](const std::size_t i) {
      const BatchOfCopies& batch = batching.batches()[i];
      const auto me = static_cast<std::uint32_t>(i + 1);
      const auto enter = [&](std::atomic<std::uint32_t>& user) {
        const std::uint32_t other = user.exchange(me);
        n_met += other != 0 && other != me ? 1 : 0;
      };
      for (std::uint32_t lane = 0; lane < batch.n_used; ++lane) {
        enter(users_of_coarse[coarse(batch.copies[lane])]);
        for (const auto& of_lanes : batch.corners) {
          enter(users[of_lanes[lane]]);
          if (auto& sequence = all[of_lanes[lane]]; sequence.empty() || sequence.back() != i)
            sequence.push_back(i);
        }
      }
      for (std::uint32_t lane = 0; lane < batch.n_used; ++lane) {
        users_of_coarse[coarse(batch.copies[lane])] = 0;
        for (const auto& of_lanes : batch.corners)
          users[of_lanes[lane]] = 0;
      }
    };
    with_threads(n_threads, [&] { batching.for_each_in_order(note); });
    return all;
  };
  dealii::MultithreadInfo::set_thread_limit(4); // by itself deal.II allows no more than there are processors
  const Sequences by_one = sequences(1);
  for (int turn = 0; turn < 20; ++turn)
    EXPECT_EQ(sequences(4), by_one);
  EXPECT_EQ(n_met, 0);
}

} // namespace
} // namespace kerf::fem::batches_test
