#include "server/front/loop/event_loop.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

namespace uplink::front {
namespace {

/// One end of a pair of sockets that the loop watches; the test holds the other.
class Watched final : public ReadyOwner {
 public:
  Watched() {
    std::array<int, 2> pair{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, pair.data()), 0);
    mine_ = pair[0];
    other_ = pair[1];
  }
  ~Watched() override {
    CloseMine();
    ::close(other_);
  }
  Watched(const Watched&) = delete;
  Watched& operator=(const Watched&) = delete;

  void OnReady(std::uint32_t events) override { on_ready(events); }
  [[nodiscard]] Turn turn() const override { return its_turn; }
  void CloseMine() {
    if (mine_ >= 0) ::close(std::exchange(mine_, -1));
  }
  /// The peer says something.
  void Say() const { EXPECT_EQ(::send(other_, "x", 1, MSG_NOSIGNAL), 1); }
  [[nodiscard]] int descriptor() const { return mine_; }

  Turn its_turn = Turn::kNow;
  std::function<void(std::uint32_t)> on_ready = [](std::uint32_t /*events*/) {};

 private:
  int mine_ = -1;
  int other_ = -1;
};

class EventLoopTest : public ::testing::Test {
 protected:
  std::vector<std::string> said_;
  std::function<void()> on_timer_ = [] {};
  EventLoop loop_{{.timer = [this] { on_timer_(); },
                   .after =
                       [this] {
                         ++batches_;
                         on_after_();
                       }}};
  std::function<void()> on_after_ = [] {};
  int batches_ = 0;
};

TEST_F(EventLoopTest, RunsWhatIsPostedInItsOrderAndThenWhatThatPosts) {
  loop_.Post([this] {
    said_.emplace_back("first");
    loop_.Post([this] {
      said_.emplace_back("third");
      loop_.Stop();
    });
  });
  loop_.Post([this] { said_.emplace_back("second"); });
  loop_.Run();
  EXPECT_EQ(said_, (std::vector<std::string>{"first", "second", "third"}));
  EXPECT_GE(batches_, 2);
}

TEST_F(EventLoopTest, OtherThreadsPost) {
  constexpr int kEach = 1000;
  constexpr int kThreads = 4;
  int ran = 0;
  const std::function<void()> work = [this, &ran] {
    if (++ran == kEach * kThreads) loop_.Stop();
  };
  const auto post_all = [this, &work] {
    for (int i = 0; i < kEach; ++i) loop_.Post(work);
  };
  std::vector<std::jthread> threads;
  threads.reserve(kThreads);
  for (int i = 0; i < kThreads; ++i) threads.emplace_back(post_all);
  loop_.Run();
  EXPECT_EQ(ran, kEach * kThreads);
}

TEST_F(EventLoopTest, TellsAgainUntilAllIsRead) {
  Watched watched;
  ASSERT_TRUE(loop_.Watch(watched.descriptor(), watched));
  watched.Say();
  watched.Say();
  int told = 0;
  watched.on_ready = [&](std::uint32_t events) {
    EXPECT_NE(events & EPOLLIN, 0U);
    char byte = 0;
    EXPECT_EQ(::read(watched.descriptor(), &byte, 1), 1);
    if (++told == 2) loop_.Stop();
  };
  loop_.Run();
  EXPECT_EQ(told, 2);
}

TEST_F(EventLoopTest, TellsOfRoomToWriteOnlyWhileThatIsWanted) {
  Watched watched;
  ASSERT_TRUE(loop_.Watch(watched.descriptor(), watched));
  loop_.WatchSending(watched.descriptor(), watched, true);
  watched.on_ready = [&](std::uint32_t events) {
    EXPECT_EQ(events, EPOLLOUT);
    said_.emplace_back("room");
    loop_.WatchSending(watched.descriptor(), watched, false);
    loop_.Post([this] { loop_.Post([this] { loop_.Stop(); }); });
  };
  loop_.Run();
  EXPECT_EQ(said_, std::vector<std::string>{"room"});
}

TEST_F(EventLoopTest, WhatAnEventPostsRunsBehindTheOthersThatItMayDestroy) {
  auto first = std::make_unique<Watched>();
  auto second = std::make_unique<Watched>();
  const auto told = [&](std::unique_ptr<Watched>& other) {
    said_.emplace_back("told");
    // Whichever comes first has both destroyed, while the other's event is still to be told.
    if (said_.size() > 1) return;
    loop_.Post([&] {
      said_.emplace_back("destroyed");
      first.reset();
      second.reset();
      loop_.Stop();
    });
    other->CloseMine();
  };
  first->on_ready = [&](std::uint32_t /*events*/) { told(second); };
  second->on_ready = [&](std::uint32_t /*events*/) { told(first); };
  ASSERT_TRUE(loop_.Watch(first->descriptor(), *first));
  ASSERT_TRUE(loop_.Watch(second->descriptor(), *second));
  first->Say();
  // The loop is woken for posts in the same round, and between the two.
  loop_.Post([] {});
  second->Say();
  loop_.Run();
  EXPECT_EQ(said_, (std::vector<std::string>{"told", "told", "destroyed"}));
}

TEST_F(EventLoopTest, AClosedDescriptorIsOutByItself) {
  Watched watched;
  ASSERT_TRUE(loop_.Watch(watched.descriptor(), watched));
  watched.Say();
  watched.on_ready = [&](std::uint32_t /*events*/) { ADD_FAILURE() << "it was closed"; };
  watched.CloseMine();
  loop_.Post([this] { loop_.Post([this] { loop_.Stop(); }); });
  loop_.Run();
}

TEST_F(EventLoopTest, RefusesADescriptorThatTheSystemDoesNotWatch) {
  Watched watched;
  EXPECT_FALSE(loop_.Watch(-1, watched));
}

TEST_F(EventLoopTest, TheTimerFiresOnceAndEvenWhereItWasDueBefore) {
  on_timer_ = [this] {
    said_.emplace_back("timer");
    loop_.Post([this] { loop_.Post([this] { loop_.Stop(); }); });
  };
  loop_.SetTimer(std::chrono::milliseconds(-5));
  loop_.Run();
  EXPECT_EQ(said_, std::vector<std::string>{"timer"});
}

TEST_F(EventLoopTest, ATimerIsReplacedAndTakenBack) {
  on_timer_ = [this] {
    said_.emplace_back("timer");
    loop_.Stop();
  };
  loop_.SetTimer(std::chrono::hours(1));
  loop_.SetTimer(std::nullopt);
  loop_.SetTimer(std::chrono::milliseconds(1));
  loop_.Run();
  EXPECT_EQ(said_, std::vector<std::string>{"timer"});
}

/// Sockets that are all ready; each says its name once it has its turn.
class EventLoopTurns : public EventLoopTest {
 protected:
  Watched& Add(Turn turn, const std::string& name) {
    Watched& watched = *watched_.emplace_back(std::make_unique<Watched>());
    watched.its_turn = turn;
    watched.on_ready = [this, name, &watched](std::uint32_t /*events*/) {
      said_.push_back(name);
      watched.CloseMine();
      if (said_.size() == watched_.size()) loop_.Stop();
    };
    EXPECT_TRUE(loop_.Watch(watched.descriptor(), watched));
    watched.Say();
    return watched;
  }

  std::vector<std::unique_ptr<Watched>> watched_;
};

TEST_F(EventLoopTurns, HandshakesComeBehindWhatElseIsReadyByWhoseTheyAre) {
  Add(Turn::kHandshake, "stranger");
  Add(Turn::kKnownHandshake, "known");
  Add(Turn::kOwnHandshake, "own");
  Add(Turn::kNow, "robot");
  Add(Turn::kNow, "another");
  loop_.Run();
  EXPECT_EQ(said_, (std::vector<std::string>{"robot", "another", "own", "known", "stranger"}));
}

TEST_F(EventLoopTurns, WhatBecomesReadyDuringAHandshakeComesBeforeTheNextOne) {
  Watched robot;
  robot.on_ready = [&](std::uint32_t /*events*/) {
    said_.emplace_back("robot");
    robot.CloseMine();
  };
  ASSERT_TRUE(loop_.Watch(robot.descriptor(), robot));
  Watched& first = Add(Turn::kHandshake, "first");
  first.on_ready = [&, on_ready = first.on_ready](std::uint32_t events) {
    on_ready(events);
    robot.Say();
  };
  Add(Turn::kHandshake, "second");
  Add(Turn::kHandshake, "third");
  Add(Turn::kHandshake, "fourth");
  Add(Turn::kHandshake, "fifth");
  loop_.Run();
  ASSERT_GE(said_.size(), 3U);
  EXPECT_EQ(said_[0], "first");
  EXPECT_EQ(said_[1], "robot");
  EXPECT_EQ(said_[2], "second");
}

TEST_F(EventLoopTurns, OneStepInFourIsOfWhoWasReadyFirst) {
  Add(Turn::kHandshake, "stranger");
  for (const char* name : {"1", "2", "3", "4", "5"}) Add(Turn::kKnownHandshake, name);
  loop_.Run();
  EXPECT_EQ(said_[3], "stranger");
}

TEST_F(EventLoopTurns, WhereMuchIsReadyHandshakesHaveTheirShare) {
  for (std::size_t i = 0; i < 2 * EventLoop::kEventsPerHandshake; ++i) Add(Turn::kNow, "robot");
  for (int i = 0; i < 3; ++i) Add(Turn::kHandshake, "handshake");
  int steps = 0;
  on_after_ = [&] {
    if (batches_ == 1) steps = static_cast<int>(std::ranges::count(said_, "handshake"));
  };
  loop_.Run();
  EXPECT_EQ(steps, 3) << "one, and two more for so many events";
}

}  // namespace
}  // namespace uplink::front
