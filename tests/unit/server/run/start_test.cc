#include "server/run/start.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::run {
namespace {

using ::testing::ElementsAre;

/// Steps that write down that they were done.
class StartTest : public ::testing::Test {
 protected:
  absl::Status Run() {
    return Start({.read_robots = [this] { done_.emplace_back("robots"); },
                  .start_writers = [this] { done_.emplace_back("writers"); },
                  .listen_for_robots = [this] { return Listen(); },
                  .answer_http = [this] { done_.emplace_back("http"); },
                  .tell_ready = [this] { done_.emplace_back("ready"); },
                  .begin_work = [this] { done_.emplace_back("work"); }});
  }
  absl::Status Listen() {
    done_.emplace_back("relay");
    return listens_;
  }

  std::vector<std::string> done_;
  absl::Status listens_;
};

// The watchdog's first beat is work: the service manager hears READY=1 before it.
TEST_F(StartTest, WhateverIsLetInFindsWhatTakesIt) {
  EXPECT_TRUE(Run().ok());
  EXPECT_THAT(done_, ElementsAre("robots", "writers", "relay", "http", "ready", "work"));
}

TEST_F(StartTest, NobodyIsJudgedWhereTheRelayCannotListen) {
  listens_ = absl::UnavailableError("no address");
  EXPECT_EQ(Run(), listens_);
  EXPECT_THAT(done_, ElementsAre("robots", "writers", "relay"));
}

TEST(StopTest, TheWritersOutliveTheStreamsAndHttpOutlivesTheWriters) {
  std::vector<std::string> done;
  Stop({.stop_relay = [&done] { done.emplace_back("relay"); },
        .stop_writers = [&done] { done.emplace_back("writers"); },
        .stop_loop = [&done] { done.emplace_back("loop"); },
        .end_readers = [&done] { done.emplace_back("readers"); }});
  EXPECT_THAT(done, ElementsAre("relay", "writers", "loop", "readers"));
}

}  // namespace
}  // namespace uplink::run
