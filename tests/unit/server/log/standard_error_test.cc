#include "server/log/standard_error.h"

#include <csignal>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"
#include "tests/support/small_pipe.h"

namespace uplink::log {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using testing::kPatience;
using testing::ManualClock;
using testing::SmallPipe;
using ::testing::StartsWith;

class StandardErrorTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::unique_ptr<LineSink> Sink(StandardErrorOptions options = {}) const {
    options.descriptor = pipe_.writer();
    return StandardError(clock_, options);
  }

  const ManualClock clock_{FromUnixMs(1'700'000'000'007)};
  SmallPipe pipe_;
};

TEST_F(StandardErrorTest, WritesTheLineAndNothingElse) {
  ::testing::internal::CaptureStderr();
  StandardError(clock_, {})->Write(Level::kInfo, "one line {} %v");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "one line {} %v\n");
}

TEST_F(StandardErrorTest, BeginsALineWithItsPriorityForTheJournal) {
  const auto sink = Sink({.format = Format::kText, .priorities = true, .limits = {}});
  sink->Write(Level::kDebug, "d");
  sink->Write(Level::kInfo, "i");
  sink->Write(Level::kWarn, "w");
  sink->Write(Level::kError, "e");
  EXPECT_EQ(pipe_.ReadUntil("e\n"), "<7>d\n<6>i\n<4>w\n<3>e\n");
}

TEST_F(StandardErrorTest, AReaderThatStallsCostsLinesAndALineSaysHowMany) {
  pipe_.Fill();
  const auto sink = Sink({.format = Format::kText,
                          .priorities = true,
                          .limits = {.lines_max = 2, .bytes_max = 1'000}});
  for (const char* line : {"1", "2", "3", "4", "5"}) sink->Write(Level::kInfo, line);
  EXPECT_EQ(sink->counts().waiting, 2U);
  EXPECT_EQ(sink->counts().dropped, 3U);
  // They are told in one line, or in two if the thread took its lines between them.
  const std::string& text = pipe_.ReadUntil("lines=");
  const std::string rest = text.ends_with("lines=1\n") ? "lines=2\n" : "lines=1\n";
  const bool in_one = text.ends_with("lines=3\n");
  if (!in_one) pipe_.ReadUntil(rest);
  // There is room again once the first lines are written.
  sink->Flush(kPatience);
  sink->Write(Level::kInfo, "6");
  const std::string told = "<4>2023-11-14T22:13:20.007Z warn log_lines_lost lines=";
  EXPECT_THAT(pipe_.ReadUntil("<6>6\n").substr(SmallPipe::kBytes),
              AllOf(StartsWith("<6>1\n<6>2\n" + told),
                    EndsWith(in_one ? told + "3\n<6>6\n" : told + rest.substr(6) + "<6>6\n")));
  EXPECT_EQ(sink->counts().dropped, 3U);
}

TEST_F(StandardErrorTest, TellsOfALossInTheFormOfTheOtherLines) {
  pipe_.Fill();
  const auto sink = Sink({.format = Format::kJson,
                          .priorities = false,
                          .limits = {.lines_max = 1, .bytes_max = 1'000}});
  sink->Write(Level::kInfo, "{}");
  sink->Write(Level::kInfo, "{}");
  EXPECT_THAT(pipe_.ReadUntil("}\n{"), ::testing::HasSubstr("{}\n{\"time\""));
  EXPECT_THAT(pipe_.ReadUntil("lines\":1}\n"),
              EndsWith(R"("level":"warn","event":"log_lines_lost","lines":1})"
                       "\n"));
}

TEST_F(StandardErrorTest, LinesThatNobodyCanReadAreCounted) {
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  pipe_.CloseReader();
  const auto sink = Sink();
  sink->Write(Level::kInfo, "1");
  sink->Write(Level::kInfo, "2");
  sink->Flush(kPatience);
  EXPECT_EQ(sink->counts().waiting, 0U);
  EXPECT_EQ(sink->counts().dropped, 2U);
  std::signal(SIGPIPE, before);
}

TEST_F(StandardErrorTest, WritesWhatWaitsBeforeItEnds) {
  auto sink = Sink();
  for (int i = 0; i < 100; ++i) sink->Write(Level::kInfo, "a line");
  sink->Write(Level::kInfo, "the last");
  std::jthread reader([this] { pipe_.ReadUntil("the last\n"); });
  sink.reset();
  pipe_.CloseWriter();
  reader.join();
  EXPECT_THAT(pipe_.text(), EndsWith("a line\nthe last\n"));
}

}  // namespace
}  // namespace uplink::log
