#include "server/loop/read_threads.h"

#include <future>
#include <memory>
#include <string>

#include <gtest/gtest.h>

namespace uplink::loop {
namespace {

constexpr ThreadKind kKind{"read", 10};

TEST(ReadThreads, RunsJobsInOrderOnItsOwnThread) {
  metrics::Cell waiting;
  metrics::Cell refused;
  ReadThreads thread(waiting, refused, kKind);
  std::promise<std::thread::id> first;
  std::promise<int> second;
  ASSERT_TRUE(thread.TryPost([&] { first.set_value(std::this_thread::get_id()); }));
  ASSERT_TRUE(thread.TryPost([&] { second.set_value(2); }));
  EXPECT_NE(first.get_future().get(), std::this_thread::get_id());
  EXPECT_EQ(second.get_future().get(), 2);
}

TEST(ReadThreads, WhatIsPostedAheadRunsFirstAndHasABoundOfItsOwn) {
  metrics::Cell waiting;
  metrics::Cell refused;
  ReadThreads thread(waiting, refused, kKind, {.waiting_max = 1});
  std::promise<void> started;
  std::promise<void> release;
  std::promise<void> done;
  std::string order;
  ASSERT_TRUE(thread.TryPost([&] {
    started.set_value();
    release.get_future().wait();
  }));
  started.get_future().wait();
  ASSERT_TRUE(thread.TryPost([&] {
    order += "last";
    done.set_value();
  }));
  EXPECT_FALSE(thread.TryPost([] {}));
  ASSERT_TRUE(thread.TryPostAhead([&] { order += "first "; }));
  for (std::size_t i = 1; i < kReadsAheadMax; ++i) ASSERT_TRUE(thread.TryPostAhead([] {}));
  EXPECT_FALSE(thread.TryPostAhead([] {}));
  EXPECT_EQ(refused.value(), 2);
  release.set_value();
  done.get_future().wait();
  EXPECT_EQ(order, "first last");
  EXPECT_EQ(waiting.value(), 0);
}

TEST(ReadThreads, RefusesPastItsBoundAndTakesAgainAfterwards) {
  metrics::Cell waiting;
  metrics::Cell refused;
  ReadThreads thread(waiting, refused, kKind);
  std::promise<void> started;
  std::promise<void> release;
  std::promise<void> last;
  ASSERT_TRUE(thread.TryPost([&] {
    started.set_value();
    release.get_future().wait();
  }));
  started.get_future().wait();
  for (std::size_t i = 0; i + 1 < kReadsWaitingMax; ++i) ASSERT_TRUE(thread.TryPost([] {}));
  ASSERT_TRUE(thread.TryPost([&] { last.set_value(); }));
  EXPECT_EQ(waiting.value(), static_cast<std::int64_t>(kReadsWaitingMax));
  EXPECT_FALSE(thread.TryPost([] {}));
  EXPECT_EQ(refused.value(), 1);
  release.set_value();
  last.get_future().wait();
  EXPECT_TRUE(thread.TryPost([] {}));
}

TEST(ReadThreads, AJobThatIsWithdrawnMakesRoomAndLeavesNothing) {
  metrics::Cell waiting;
  metrics::Cell refused;
  ReadThreads thread(waiting, refused, kKind, {.waiting_max = 2, .ahead_max = 1});
  std::promise<void> started;
  std::promise<void> release;
  std::promise<void> done;
  std::string order;
  const auto running = thread.TryPost([&] {
    started.set_value();
    release.get_future().wait();
  });
  ASSERT_TRUE(running);
  started.get_future().wait();
  auto held = std::make_shared<int>();
  const auto first = thread.TryPost([&order, held] { order += "first "; });
  const auto ahead = thread.TryPostAhead([&order, held] { order += "ahead "; });
  ASSERT_TRUE(first);
  ASSERT_TRUE(ahead);
  ASSERT_TRUE(thread.TryPost([&] { order += "second "; }));
  ASSERT_FALSE(thread.TryPost([] {}));
  thread.Withdraw(*first);
  thread.Withdraw(*ahead);
  thread.Withdraw(*first);
  thread.Withdraw(*running);
  EXPECT_EQ(held.use_count(), 1);
  EXPECT_EQ(waiting.value(), 1);
  ASSERT_TRUE(thread.TryPost([&] {
    order += "third";
    done.set_value();
  }));
  release.set_value();
  done.get_future().wait();
  EXPECT_EQ(order, "second third");
  EXPECT_EQ(waiting.value(), 0);
}

TEST(ReadThreads, ALongJobDelaysNoOtherWhileThreadsAreFree) {
  metrics::Cell waiting;
  metrics::Cell refused;
  ReadThreads threads(waiting, refused, kKind, {.threads = 2});
  std::promise<void> started;
  std::promise<void> release;
  std::promise<void> ended;
  ASSERT_TRUE(threads.TryPost([&] {
    started.set_value();
    release.get_future().wait();
    ended.set_value();
  }));
  started.get_future().wait();
  std::promise<void> other;
  ASSERT_TRUE(threads.TryPost([&] { other.set_value(); }));
  other.get_future().wait();
  release.set_value();
  ended.get_future().wait();
}

}  // namespace
}  // namespace uplink::loop
