#pragma once

/// Places in a row, of which things take several that follow each other and give them back: which ones are free.
///
/// Free places that touch each other are one run. Things take the shortest run that has room for them, of these the
/// lowest, and what they leave of it stays free; where no run has room, they take places at the end. So which places
/// are taken hangs on the order of what came before alone. The cost of one: the logarithm of the number of runs.

#include "base/archive.h"

#include <cstddef>
#include <map>
#include <set>
#include <utility>

namespace kerf::texture {

class FreePlaces {
 public:
  /// The first of n places, which are taken from now on.
  std::size_t take(std::size_t n);
  /// n places from `first` on, which had been taken.
  void give_back(std::size_t first, std::size_t n);
  /// None is taken from here on.
  std::size_t end() const { return end_; }

  void archive(Archive& a);

 private:
  using Run = std::map<std::size_t, std::size_t>::iterator;

  void add(std::size_t first, std::size_t n);
  void remove(Run run);

  std::size_t end_ = 0;
  std::map<std::size_t, std::size_t> length_of_;            ///< of each run, by its first place; none touches the end
  std::set<std::pair<std::size_t, std::size_t>> by_length_; ///< of each run its length, its first place
};

} // namespace kerf::texture
