#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/component/front/raw_robot.h"
#include "tests/support/kept_lines.h"

namespace uplink::testing {

/// The whole listener with several threads, and clients on threads of their own: for
/// ThreadSanitizer, and for what only shows when all of it happens at once. Whatever happens: what
/// was acked is stored once, and in the end nothing is left.
class FrontThreads : public ::testing::Test {
 protected:
  static constexpr std::size_t kThreads = 4;
  static constexpr int kRobots = 6;
  static constexpr int kRounds = 8;
  static constexpr int kBatches = 3;

  static ListenerWorld::Options ManyThreads() {
    ListenerWorld::Options options;
    options.queues = kThreads;
    // No stream waits since its robot comes often.
    options.session.reconnects.per_minute = robot::kStreamTimesMax;
    return options;
  }

  explicit FrontThreads(const ListenerWorld::Options& options = ManyThreads())
      : world_(WithLines(options)) {
    for (int i = 0; i < kRobots; ++i) {
      keys_.push_back(RobotKeys(world_, i));
      AddRobot(i, 1, world_.port());
    }
  }

  void SetUp() override {
    watcher_ = std::jthread([this](const std::stop_token& stop) { Watch(stop); });
  }

  void TearDown() override {
    EXPECT_TRUE(Eventually([this] { return world_.server().streams() == 0; }));
    world_.StopServer();
    watcher_ = {};
    EXPECT_EQ(world_.relay_probe.connections.value(), 0);
    EXPECT_EQ(world_.relay_probe.handshakes_under_way.value(), 0);
    EXPECT_TRUE(world_.Settles());
    for (const auto& robot : robots_) ExpectStored(*robot);
  }

  void AddRobot(int number, std::uint8_t session, std::uint16_t port) {
    RawHttp2::Options options = ClientOf(world_, keys_.at(static_cast<std::size_t>(number)));
    options.port = port;
    robots_.push_back(std::make_unique<RawRobot>(options, RuriOf(number), session));
  }

  void ExpectStored(const RawRobot& robot) {
    const SessionLog log = world_.database.Log(robot.ruri(), robot.session());
    EXPECT_GE(log.stored.size(), robot.acked());
    EXPECT_TRUE(std::ranges::all_of(log.times_written, [](auto each) { return each.second == 1; }));
  }

  /// Runs the work of each robot on a thread of its own.
  void ForEachRobot(const std::function<void(RawRobot&)>& work) {
    std::vector<std::jthread> threads;
    threads.reserve(robots_.size());
    for (const auto& robot : robots_) {
      threads.emplace_back([&work, &robot] { work(*robot); });
    }
  }
  /// Comes back until the server is gone; counts the batches that were acked.
  static void StreamToTheEnd(RawRobot& robot, std::atomic<int>& batches) {
    while (robot.Connect()) {
      while (robot.StreamBatch()) ++batches;
    }
  }

  /// So that what makes lines runs too.
  ListenerWorld::Options WithLines(ListenerWorld::Options options) {
    options.logger = &logger_;
    return options;
  }

  const SystemClock clock_;
  const log::Logger logger_{std::make_unique<NoLines>(), clock_, log::Format::kText,
                            log::Level::kInfo};
  ListenerWorld world_;
  std::vector<KeyPair> keys_;
  std::vector<std::unique_ptr<RawRobot>> robots_;

 private:
  /// Looks at all that a scrape looks at.
  void Watch(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      static_cast<void>(Eventually([&stop] { return stop.stop_requested(); }, milliseconds(5)));
      EXPECT_TRUE(world_.Counts().Balanced());
      static_cast<void>(world_.server().streams());
      static_cast<void>(world_.server().draining());
      for (const auto& cell : world_.relay_probe.turned_away_total) EXPECT_GE(cell.value(), 0);
    }
  }

  std::jthread watcher_;
};

}  // namespace uplink::testing
