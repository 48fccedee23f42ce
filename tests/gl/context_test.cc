#include "gl/context.h"

#include "gl/framebuffer.h"

#include <gtest/gtest.h>

namespace kerf::gl::context_test {
namespace {

TEST(Context, IsCoreProfile33OrLater) {
  const Context context;
  const Version v = context.version();
  EXPECT_GE(10 * v.major + v.minor, 33);
  EXPECT_FALSE(context.device().empty());
}

TEST(Context, TwoAtOnceKeepTheirImagesApart) {
  const Context first;
  const Framebuffer red({.width = 2, .height = 2});
  red.clear({1, 0, 0, 1});
  {
    const Context second;
    const Framebuffer green({.width = 2, .height = 2});
    green.clear({0, 1, 0, 1});
    first.make_current();
    EXPECT_EQ(red.read_rgba8()[0], 255);
    second.make_current();
    EXPECT_EQ(green.read_rgba8()[0], 0);
  }
  first.make_current();
  EXPECT_EQ(red.read_rgba8()[0], 255);
}

} // namespace
} // namespace kerf::gl::context_test
