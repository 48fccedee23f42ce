#include "base/work_thread.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <semaphore>

namespace kerf::work_thread_test {
namespace {

TEST(WorkThread, DoesOnePieceAfterTheOther) {
  std::vector<int> done;
  {
    WorkThread thread;
    for (int i = 0; i < 100; ++i)
      thread.give([&done, i] { done.push_back(i); });
    thread.wait();
    EXPECT_EQ(done.size(), 100u);
    thread.give([&] { done.push_back(100); });
  }
  ASSERT_EQ(done.size(), 101u) << "nothing that was given is lost";
  for (int i = 0; i < 101; ++i)
    EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
}

TEST(WorkThread, KeepsTwoPieces) {
  WorkThread thread;
  std::counting_semaphore<> go(0);
  std::atomic<int> n_given = 0;
  std::thread giver([&] {
    for (int i = 0; i < 4; ++i) {
      thread.give([&] { go.acquire(); });
      ++n_given;
    }
  });
  while (n_given < 2)
    std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(n_given, 2) << "one is being done, one waits, the third has no room";
  go.release(4);
  giver.join();
  thread.wait();
}

TEST(WorkThread, TellsOnceWhatFails) {
  WorkThread thread;
  bool done = false;
  thread.give([] { throw DataError("full"); });
  EXPECT_THROW(thread.wait(), DataError);
  thread.give([&] { done = true; });
  EXPECT_NO_THROW(thread.wait());
  EXPECT_TRUE(done);
}

TEST(WorkThread, CountsItsTime) {
  WorkThread thread;
  double sum = 0;
  thread.give([&sum] {
    for (int i = 0; i < 20000000; ++i)
      sum += std::sqrt(double(i));
  });
  thread.wait();
  EXPECT_GT(sum, 0);
  EXPECT_GT(thread.cpu_seconds(), 1e-3);
  EXPECT_LT(thread.cpu_seconds(), 100);
}

} // namespace
} // namespace kerf::work_thread_test
