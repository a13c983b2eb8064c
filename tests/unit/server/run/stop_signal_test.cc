#include "server/run/stop_signal.h"

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
  StopSignal signal_{logger_};
};

TEST_F(StopSignalTest, OneDuringTheStartEndsTheProcessWithZero) {
  EXPECT_EXIT(signal_.OnSignal(SIGTERM), ::testing::ExitedWithCode(0), "");
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
