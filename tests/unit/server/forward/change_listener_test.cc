// Another server's commits wake the look here, and ours are told.
#include "server/forward/change_listener.h"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/forward/limits.h"
#include "tests/support/eventually.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::forward {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// What Wait answers stands in a list; after that it waits for its end.
class ScriptedSignal final : public storage::ChangeSignal {
 public:
  explicit ScriptedSignal(std::deque<absl::StatusOr<bool>> answers = {})
      : answers_(std::move(answers)) {}

  void Tell() override { ++told; }
  absl::StatusOr<bool> Wait(milliseconds most) override {
    std::unique_lock lock(mutex_);
    ++waits;
    longest = most;
    if (!answers_.empty()) {
      absl::StatusOr<bool> answer = answers_.front();
      answers_.pop_front();
      return answer;
    }
    end_.wait(lock, [this] { return ended_; });
    return false;
  }
  void End() override {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    end_.notify_all();
  }

  std::atomic<int> told = 0;
  std::atomic<int> waits = 0;
  milliseconds longest{0};

 private:
  std::mutex mutex_;
  std::condition_variable end_;
  bool ended_ = false;
  std::deque<absl::StatusOr<bool>> answers_;
};

class ChangeListenerTest : public ::testing::Test {
 protected:
  ChangeListener::Context With(storage::ChangeSignal* signal) {
    return {logger_, probe_, signal, [this] { ++woken_; }, 1};
  }

  std::vector<std::string> lines_;
  const testing::ManualClock clock_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  ForwardProbe probe_;
  std::atomic<int> woken_ = 0;
};

TEST_F(ChangeListenerTest, WhatAnotherTellsWakesAndIsCounted) {
  ScriptedSignal signal({false, true, false, true});
  ChangeListener listener(With(&signal));
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(listener.Round().ok());
  EXPECT_EQ(woken_, 2);
  EXPECT_EQ(probe_.heard.value(), 2);
  EXPECT_EQ(probe_.listen_failing.value(), 0);
  EXPECT_EQ(signal.longest, kLookEvery);
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(ChangeListenerTest, OwnCommitsAreTold) {
  ScriptedSignal signal;
  ChangeListener listener(With(&signal));
  listener.Tell();
  EXPECT_EQ(signal.told, 1);
  EXPECT_EQ(woken_, 0);
}

TEST_F(ChangeListenerTest, AFailureIsLoggedOnceAndSoIsItsEnd) {
  const absl::Status away = absl::UnavailableError("away");
  ScriptedSignal signal({false, away, away, false, true, away});
  ChangeListener listener(With(&signal));
  EXPECT_TRUE(listener.Round().ok());
  EXPECT_EQ(listener.Round(), away);
  EXPECT_EQ(listener.Round(), away);
  EXPECT_EQ(probe_.listen_failing.value(), 1);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forward_listen_failed why=away")));
  EXPECT_TRUE(listener.Round().ok());
  EXPECT_TRUE(listener.Round().ok());
  EXPECT_EQ(probe_.listen_failing.value(), 0);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("failed"), HasSubstr("forward_hears_again")));
  EXPECT_EQ(listener.Round(), away);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("failed"), HasSubstr("again"), HasSubstr("failed")));
}

TEST_F(ChangeListenerTest, ItsThreadTriesAgainUntilItHears) {
  ScriptedSignal signal({absl::UnavailableError("away"), absl::UnavailableError("away"), true});
  ChangeListener listener(With(&signal));
  listener.Start();
  EXPECT_TRUE(testing::Eventually([&] { return woken_ == 1; }));
  EXPECT_EQ(probe_.heard.value(), 1);
}

TEST_F(ChangeListenerTest, AStopEndsAWaitUnderWay) {
  ScriptedSignal signal;
  ChangeListener listener(With(&signal));
  listener.Start();
  ASSERT_TRUE(testing::Eventually([&] { return signal.waits == 1; }));
  listener.Stop();
  EXPECT_LE(signal.waits, 2);
  listener.Stop();
}

TEST_F(ChangeListenerTest, AStopEndsAPauseBetweenTries) {
  ScriptedSignal signal(std::deque<absl::StatusOr<bool>>(100, absl::UnavailableError("away")));
  ChangeListener listener(With(&signal));
  listener.Start();
  ASSERT_TRUE(testing::Eventually([&] { return signal.waits == 3; }));
  listener.Stop();
  EXPECT_LT(signal.waits, 100) << "each pause is longer than the last one, up to seconds";
}

TEST_F(ChangeListenerTest, WhereOneProcessHasTheStoreThereIsNothingToHear) {
  ChangeListener listener(With(nullptr));
  listener.Start();
  listener.Tell();
  listener.Stop();
  EXPECT_EQ(woken_, 0);
}

}  // namespace
}  // namespace uplink::forward
