#include "server/run/stop_signal.h"

#include <iostream>
#include <memory>
#include <thread>

#include <gtest/gtest.h>
#include <signal.h>

#include "tests/support/kept_lines.h"

namespace uplink::run {
namespace {

class StopSignalTest : public ::testing::Test {
 protected:
  SystemClock clock_;
  log::Logger logger_{std::make_unique<testing::NoLines>(), clock_, log::Format::kText,
                      log::Level::kInfo};
  StopSignal signal_{logger_, [](int /*signal*/) {}};
};

TEST_F(StopSignalTest, OneDuringTheStartEndsTheProcessWithZero) {
  StopSignal signal(logger_, [](int number) { std::cerr << "stopped by " << number; });
  EXPECT_EXIT(signal.OnSignal(SIGTERM), ::testing::ExitedWithCode(0), "stopped by 15");
}

TEST_F(StopSignalTest, TheFirstEndsTheWait) {
  signal_.NoteStarted();
  const std::jthread loop([this] { signal_.OnSignal(SIGTERM); });
  signal_.Wait();
}

TEST_F(StopSignalTest, AFailureEndsTheWaitAndTheProcessWithOne) {
  signal_.NoteStarted();
  EXPECT_EQ(signal_.exit_code(), 0);
  signal_.OnFailure();
  signal_.OnFailure();
  signal_.Wait();
  EXPECT_EQ(signal_.exit_code(), 1);
}

TEST_F(StopSignalTest, TheFirstAfterAFailureLetsTheDrainGoOn) {
  signal_.NoteStarted();
  signal_.OnFailure();
  signal_.OnSignal(SIGTERM);
  signal_.Wait();
  EXPECT_EXIT(signal_.OnSignal(SIGTERM), ::testing::ExitedWithCode(1), "");
}

TEST_F(StopSignalTest, APauseEndsByItself) {
  signal_.NoteStarted();
  signal_.OnSignal(SIGTERM);
  signal_.Wait();
  signal_.Pause(milliseconds(1));
}

TEST_F(StopSignalTest, TheSecondEndsTheProcessWithOne) {
  signal_.NoteStarted();
  signal_.OnSignal(SIGTERM);
  EXPECT_EXIT(signal_.OnSignal(SIGINT), ::testing::ExitedWithCode(1), "");
}

}  // namespace
}  // namespace uplink::run
