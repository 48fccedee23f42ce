#include "pba/reach.h"

#include <algorithm>
#include <utility>

namespace kerf::pba {

namespace {

using Row = std::uint32_t;
constexpr std::uint32_t none = Id<void>::no_value;

/// Nodes and the copies that hold them as material, and what lies in the copies.
struct Graph {
  std::vector<std::vector<grid::CopyId>> copies;   ///< of each row
  std::vector<std::vector<Row>> rows;              ///< of each copy
  std::vector<std::vector<std::uint32_t>> phyxels; ///< in each copy
};

Graph make_graph(const grid::CellComplex& complex, const std::span<const grid::NodeId> nodes,
                 const std::span<const grid::CopyId> copies) {
  Graph graph{std::vector<std::vector<grid::CopyId>>(nodes.size()), std::vector<std::vector<Row>>(complex.n_copies()),
              std::vector<std::vector<std::uint32_t>>(complex.n_copies())};
  for (const auto c : ids<grid::CopyId>(complex.n_copies()))
    for (int v = 0; v < 8; ++v)
      if (complex.copies[c].nodes >> v & 1) {
        const auto node = complex.node[complex.copies[c].corners[v]];
        const Row row = static_cast<Row>(std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin());
        graph.copies[row].push_back(c);
        graph.rows[c.value].push_back(row);
      }
  for (std::uint32_t i = 0; i < copies.size(); ++i)
    if (copies[i].valid())
      graph.phyxels[copies[i].value].push_back(i);
  return graph;
}

std::uint32_t nearest(const Vec3& p, const Points& phyxels, const std::span<const std::uint32_t> among) {
  return *std::min_element(among.begin(), among.end(), [&](const std::uint32_t i, const std::uint32_t j) {
    return std::pair((phyxels[i] - p).squaredNorm(), i) < std::pair((phyxels[j] - p).squaredNorm(), j);
  });
}

/// Copies in rings around a row.
class Walk {
 public:
  explicit Walk(const Graph& graph)
    : graph_(graph), row_seen_(graph.copies.size(), none), copy_seen_(graph.rows.size(), none) {}

  void start(const Row from) {
    from_ = from;
    row_seen_[from] = from;
    ring_ = all_ = {from};
  }

  /// The phyxels in the next ring of copies that holds any; none when there are no more.
  std::vector<std::uint32_t> next_phyxels() {
    std::vector<std::uint32_t> found;
    while (found.empty() && !ring_.empty())
      found = step();
    return found;
  }

  /// The rows met since the start.
  const std::vector<Row>& rows() const { return all_; }

 private:
  std::vector<std::uint32_t> step() {
    std::vector<std::uint32_t> found;
    std::vector<Row> next;
    for (const Row row : ring_)
      for (const auto c : graph_.copies[row]) {
        if (std::exchange(copy_seen_[c.value], from_) == from_)
          continue;
        found.insert(found.end(), graph_.phyxels[c.value].begin(), graph_.phyxels[c.value].end());
        for (const Row other : graph_.rows[c.value])
          if (std::exchange(row_seen_[other], from_) != from_)
            next.push_back(other);
      }
    all_.insert(all_.end(), next.begin(), next.end());
    ring_ = std::move(next);
    return found;
  }

  const Graph& graph_;
  Row from_ = none;
  std::vector<Row> row_seen_, copy_seen_; // in the walk from which row
  std::vector<Row> ring_, all_;
};

Vec3 mean(const Points& rest, const std::vector<Row>& rows) {
  Vec3 sum = Vec3::Zero();
  for (const Row r : rows)
    sum += rest[r];
  return sum / static_cast<double>(rows.size());
}

} // namespace

Reached reach(const grid::CellComplex& complex, const std::span<const grid::NodeId> nodes, const Points& rest,
              const Points& phyxels, const std::span<const grid::CopyId> copies,
              const std::span<const std::uint32_t> blind) {
  Reached reached{std::vector<std::uint32_t>(blind.size(), none)};
  if (blind.empty())
    return reached;
  const Graph graph = make_graph(complex, nodes, copies);
  std::vector<std::uint32_t> everyone(phyxels.size());
  for (std::uint32_t i = 0; i < everyone.size(); ++i)
    everyone[i] = i;
  Walk walk(graph);
  for (std::size_t b = 0; b < blind.size(); ++b) {
    if (reached.phyxel[b] != none)
      continue;
    walk.start(blind[b]);
    const auto found = walk.next_phyxels();
    if (!found.empty()) {
      reached.phyxel[b] = nearest(rest[blind[b]], phyxels, found);
      continue;
    }
    ++reached.n_orphans;
    const std::uint32_t carrier = nearest(mean(rest, walk.rows()), phyxels, everyone);
    for (const Row row : walk.rows())
      if (const auto it = std::lower_bound(blind.begin(), blind.end(), row); it != blind.end() && *it == row)
        reached.phyxel[it - blind.begin()] = carrier;
  }
  return reached;
}

} // namespace kerf::pba
