#include "server/front/door/source_lines.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>

#include "server/transport/turned_away.h"
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

  /// One who does everything that there is a word for, again and again.
  void WriteAllKinds(std::uint32_t source, const std::string& robot = "") {
    for (int i = 0; i < 10; ++i) {
      for (const std::string_view why : transport::kTurnedAwayTexts) Write(source, why, robot);
    }
  }
  [[nodiscard]] std::size_t LinesWith(const std::string& part) const {
    return static_cast<std::size_t>(std::count_if(
        kept_.begin(), kept_.end(),
        [&part](const std::string& line) { return line.find(part) != std::string::npos; }));
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
  EXPECT_EQ(kept_.size(), SourceLines::kLinesPerKind);
  Write(2);
  ASSERT_EQ(kept_.size(), SourceLines::kLinesPerKind + 1);
  EXPECT_NE(kept_.back().find("192.0.2.2"), std::string::npos);
}

TEST_F(SourceLinesTest, ANoisyRobotHidesNoneBehindTheSameSource) {
  for (int i = 0; i < 1000; ++i) Write(1, "pings", "rcan://acme/noisy");
  Write(1, "pings", "rcan://acme/quiet");
  ASSERT_EQ(kept_.size(), SourceLines::kLinesPerKind + 1);
  EXPECT_NE(kept_.back().find("robot=rcan://acme/quiet"), std::string::npos) << kept_.back();
}

TEST_F(SourceLinesTest, EachCauseOfASourceHasLinesOfItsOwn) {
  for (int i = 0; i < 10; ++i) Write(1);
  Write(1, "no_tls");
  EXPECT_EQ(kept_.size(), SourceLines::kLinesPerKind + 1);
}

TEST_F(SourceLinesTest, AFewSourcesThatDoEverythingHideNobodyElse) {
  for (const std::uint32_t source : {1U, 2U, 3U, 4U, 5U, 6U}) WriteAllKinds(source);
  EXPECT_EQ(LinesWith("source=192.0.2.1 "),
            SourceLines::kLinesPerSource / SourceLines::kRepeatsPart);
  EXPECT_LE(kept_.size(), SourceLines::kLinesMax / SourceLines::kRepeatsPart + 6);
  for (const std::uint32_t source : {101U, 102U, 103U}) Write(source, "no_stream");
  EXPECT_EQ(LinesWith("source=192.0.2.10"), 3U);
}

TEST_F(SourceLinesTest, ARobotThatDoesEverythingHidesNoneBehindTheSameSource) {
  WriteAllKinds(1, "rcan://acme/noisy");
  WriteAllKinds(1, "");
  for (const char* robot : {"rcan://acme/quiet1", "rcan://acme/quiet2"}) Write(1, "pings", robot);
  EXPECT_EQ(LinesWith("rcan://acme/quiet"), 2U);
  for (int i = 0; i < 100; ++i) Write(1, "pings", "rcan://acme/" + std::to_string(i));
  EXPECT_EQ(kept_.size(), SourceLines::kLinesPerSource);
}

TEST_F(SourceLinesTest, EverySourceHasALineBeforeOthersHaveMoreThanHalf) {
  constexpr std::uint32_t kSources = 30;
  for (std::uint32_t source = 100; source < 100 + kSources; ++source) {
    for (int i = 0; i < 2; ++i) Write(source);
  }
  for (std::uint32_t source = 100; source < 100 + kSources; ++source) {
    EXPECT_GE(LinesWith("source=" + SourceOf(source).ToText() + " "), 1U) << source;
  }
  EXPECT_LT(kept_.size(), 2 * kSources);
}

TEST_F(SourceLinesTest, TheNextSpanSaysHowManyWereKeptBack) {
  for (int i = 0; i < 10; ++i) Write(1);
  now_ += SourceLines::kSpan;
  Write(1);
  ASSERT_EQ(kept_.size(), SourceLines::kLinesPerKind + 1);
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
  for (std::uint32_t source = 1; source <= SourceLines::kEntriesMax; ++source) Write(source);
  now_ += SourceLines::kSpan - milliseconds(1);
  const std::size_t before = kept_.size();
  Write(0);  // all together are over their bound: kept back, from any source
  EXPECT_EQ(kept_.size(), before);
}

TEST(SourceLines, WithoutALoggerNothingIsWritten) {
  SourceLines lines(nullptr);
  lines.Write("connection_turned_away", "untrusted", "x", {.source = SourceOf(1), .text = "x"}, {});
}

}  // namespace
}  // namespace uplink::front
