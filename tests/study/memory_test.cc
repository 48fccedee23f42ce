#include "study/memory.h"

#include <gtest/gtest.h>

#include <vector>

namespace kerf::study::memory_test {
namespace {

TEST(PeakMemory, IsWhatWasNeededSinceItsStart) {
  const double megabyte = 1e6;
  {
    const PeakMemory memory;
    { const std::vector<char> block(std::size_t(100 * megabyte), 'x'); }
    EXPECT_GE(memory.beyond_start(), 95 * megabyte) << "given back since, but it was needed";
    EXPECT_LE(memory.beyond_start(), 200 * megabyte);
  }
  const PeakMemory later;
  EXPECT_LE(later.beyond_start(), 50 * megabyte) << "needed before";
}

} // namespace
} // namespace kerf::study::memory_test
