#include "server/front/source_lines.h"

#include <memory>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>

#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::front {
namespace {

using testing::KeptLines;

SourceAddress SourceOf(std::uint32_t number) {
  in_addr address{};
  address.s_addr = htonl(0xC0000200U + number);
  return SourceAddress::Of(address);
}

class SourceLinesTest : public ::testing::Test {
 protected:
  void Write(std::uint32_t source, std::string_view why = "untrusted",
             const std::string& robot = "") {
    lines_.Write("connection_turned_away", why, std::string(why),
                 {.source = SourceOf(source), .text = "192.0.2.9:1", .robot = robot}, now_);
  }

  testing::ManualClock clock_;
  std::vector<std::string> kept_;
  log::Logger logger_{std::make_unique<KeptLines>(kept_), clock_, log::Format::kText,
                      log::Level::kDebug};
  SourceLines lines_{&logger_};
  SteadyTime now_{};
};

TEST_F(SourceLinesTest, ANoisySourceHidesNobodyElse) {
  for (int i = 0; i < 1000; ++i) Write(1);
  EXPECT_EQ(kept_.size(), SourceLines::kLinesPerSource);
  Write(2);
  ASSERT_EQ(kept_.size(), SourceLines::kLinesPerSource + 1);
  EXPECT_NE(kept_.back().find("192.0.2.2"), std::string::npos);
}

TEST_F(SourceLinesTest, ANoisyRobotHidesNoneBehindTheSameSource) {
  for (int i = 0; i < 1000; ++i) Write(1, "pings", "rcan://acme/noisy");
  Write(1, "pings", "rcan://acme/quiet");
  ASSERT_EQ(kept_.size(), SourceLines::kLinesPerSource + 1);
  EXPECT_NE(kept_.back().find("robot=rcan://acme/quiet"), std::string::npos) << kept_.back();
}

TEST_F(SourceLinesTest, EachCauseOfASourceHasLinesOfItsOwn) {
  for (int i = 0; i < 10; ++i) Write(1);
  Write(1, "no_tls");
  EXPECT_EQ(kept_.size(), SourceLines::kLinesPerSource + 1);
}

TEST_F(SourceLinesTest, TheNextSpanSaysHowManyWereKeptBack) {
  for (int i = 0; i < 10; ++i) Write(1);
  now_ += SourceLines::kSpan;
  Write(1);
  ASSERT_EQ(kept_.size(), SourceLines::kLinesPerSource + 1);
  EXPECT_NE(kept_.back().find("suppressed=8"), std::string::npos) << kept_.back();
}

TEST_F(SourceLinesTest, AllSourcesTogetherAreBounded) {
  for (std::uint32_t source = 0; source < 200; ++source) Write(source);
  EXPECT_EQ(kept_.size(), SourceLines::kLinesMax);
  now_ += SourceLines::kSpan;
  Write(999);
  EXPECT_EQ(kept_.size(), SourceLines::kLinesMax + 1);
}

TEST_F(SourceLinesTest, PastItsBoundTheOldestSourceIsForgotten) {
  Write(0);
  Write(0);
  for (std::uint32_t source = 1; source <= SourceLines::kSourcesMax; ++source) Write(source);
  now_ += SourceLines::kSpan - milliseconds(1);
  const std::size_t before = kept_.size();
  Write(0);  // all together are over their bound: kept back, whoever it is
  EXPECT_EQ(kept_.size(), before);
}

TEST(SourceLines, WithoutALoggerNothingIsWritten) {
  SourceLines lines(nullptr);
  lines.Write("connection_turned_away", "untrusted", "x", {.source = SourceOf(1), .text = "x"}, {});
}

}  // namespace
}  // namespace uplink::front
