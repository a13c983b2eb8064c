// How a process ends whose log is not read.
#include <csignal>

#include <gtest/gtest.h>

#include "schema/base/check.h"
#include "schema/base/write_all.h"
#include "server/log/standard_error.h"
#include "tests/support/manual_clock.h"
#include "tests/support/small_pipe.h"

namespace uplink::log {
namespace {

using testing::ManualClock;
using testing::SmallPipe;

TEST(LogEnd, WaitsForAReaderNoLongerThanItMay) {
  const ManualClock clock;
  const SmallPipe pipe;
  pipe.Fill();
  auto sink = StandardError(
      clock,
      {.format = Format::kText, .priorities = false, .limits = {}, .descriptor = pipe.writer()});
  sink->Write(Level::kInfo, "this is not read");
  const SteadyTime began = SystemClock().Steady();
  sink->Flush(milliseconds(1));
  sink.reset();
  EXPECT_GE(SystemClock().Steady() - began, kFlushWait) << "a reader has this time";
}

TEST(LogEndDeathTest, ABrokenInvariantAbortsThoughNobodyReadsWhatItSays) {
  EXPECT_EXIT(
      {
        const SmallPipe pipe;
        pipe.Fill();
        dup2(pipe.writer(), STDERR_FILENO);
        CheckFailed("file.cc", 1, "condition", "text");
      },
      ::testing::KilledBySignal(SIGABRT), "");
}

TEST(LogEndDeathTest, ABrokenInvariantSaysWhatAndWhere) {
  EXPECT_EXIT(CheckFailed("file.cc", 1, "a == b", "they are equal"),
              ::testing::KilledBySignal(SIGABRT),
              "uplinkd: broken invariant at file.cc:1: a == b \\(they are equal\\)\n");
}

}  // namespace
}  // namespace uplink::log
