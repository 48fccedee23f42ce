#include "base/error.h"

#include <gtest/gtest.h>

namespace kerf::error_test {
namespace {

TEST(Complaint, SaysEverythingInOneLine) {
  const Complaint all{"a.prm", 12, "Time/Step [s]", "-1", "must be > 0", "The default is 0.01"};
  EXPECT_EQ(to_string(all), "a.prm:12: Time/Step [s] = '-1': must be > 0. The default is 0.01.");
}

TEST(Complaint, LeavesOutWhatIsEmpty) {
  EXPECT_EQ(to_string(Complaint{"a.prm", 0, "", "", "cannot be read", ""}), "a.prm: cannot be read.");
  EXPECT_EQ(to_string(Complaint{"", 0, "Time", "", "must be written", ""}), "Time: must be written.");
  EXPECT_EQ(to_string(Complaint{"a.prm", 3, "", "sett", "is unknown", ""}), "a.prm:3: 'sett': is unknown.");
}

TEST(Error, KindsHaveTheirExitCodes) {
  EXPECT_EQ(ParameterError("x").exit_code(), 1);
  EXPECT_EQ(DataError("x").exit_code(), 2);
  EXPECT_EQ(NumericalError("x").exit_code(), 3);
}

TEST(Error, KeepsItsComplaint) {
  const ParameterError error(Complaint{.file = "a.prm", .line = 4, .rule = "must hold"});
  EXPECT_EQ(error.complaint().line, 4);
  EXPECT_STREQ(error.what(), "a.prm:4: must hold.");
}

} // namespace
} // namespace kerf::error_test
