/// Small bodies gain nothing from a second thread, and lose much where the machine is busy: these tests run on one
/// unless they say otherwise.

#include "base/parallel.h"

#include <gtest/gtest.h>

namespace kerf::lattice {
namespace {

class OneThread : public testing::Environment {
 public:
  void SetUp() override { set_n_threads(1); }
};

[[maybe_unused]] const testing::Environment* const one_thread = testing::AddGlobalTestEnvironment(new OneThread);

} // namespace
} // namespace kerf::lattice
