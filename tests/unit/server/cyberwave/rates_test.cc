// How much a twin may send, and how many pings are answered.
#include <algorithm>
#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "server/cyberwave/pong_limit.h"
#include "server/cyberwave/twin_rates.h"
#include "tests/support/manual_clock.h"
#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using enum JournalFill;

class TwinRatesTest : public ::testing::Test {
 protected:
  /// How many of `count` such messages pass now.
  std::size_t Pass(std::size_t count, const Judgement& judgement, JournalFill fill) {
    std::size_t passed = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto limited = rates_.Limit(judgement, fill, clock_.Steady());
      if (!limited) {
        ++passed;
        continue;
      }
      EXPECT_EQ(limited->reason, model::RejectReason::kRateLimited);
    }
    return passed;
  }

  testing::ManualClock clock_;
  TwinRates rates_;
  Judgement live_ = test::JudgeOn("joint/update", R"({"_1":1})");
  Judgement command_ = test::JudgeOn("command", R"({"command":"stop"})");
  Judgement broken_ = test::JudgeOn("gps", "broken");
  Judgement event_ = test::JudgeOn("event", R"({"event_type":"bumped"})");
  Judgement line_ = test::JudgeOn("driverlog", R"({"message":"m","level":"info"})");
  Judgement telemetry_line_ =
      test::JudgeOn("telemetry", R"({"type":"driver_log","message":"m","level":"info"})");
};

TEST_F(TwinRatesTest, SoManyAtOnceAndThenSoManyPerSecond) {
  EXPECT_EQ(Pass(5'100, live_, kUpToHalf), 5'000U);
  clock_.Advance(milliseconds(500));
  EXPECT_EQ(Pass(300, live_, kUpToHalf), 300U);
  EXPECT_EQ(Pass(100, command_, kUpToHalf), 100U);
  EXPECT_EQ(Pass(200, broken_, kUpToHalf), 100U) << "what is rejected counts as well";
  clock_.Advance(seconds(100));
  EXPECT_EQ(Pass(6'000, live_, kUpToHalf), 5'000U);
}

TEST_F(TwinRatesTest, ABacklogPassesWhileTheJournalHasRoomAndHarmsNoState) {
  EXPECT_EQ(Pass(20'000, event_, kUpToHalf), 20'000U);
  EXPECT_EQ(Pass(20'000, line_, kUpToHalf), 20'000U);
  EXPECT_EQ(Pass(5'000, live_, kUpToHalf), 5'000U);
  EXPECT_EQ(Pass(1, event_, kOverHalf), 0U);
  clock_.Advance(seconds(1));
  EXPECT_EQ(Pass(1'100, event_, kOverHalf), 1'000U);
}

TEST_F(TwinRatesTest, LinesOfLogsHaveARateOfTheirOwn) {
  EXPECT_EQ(Pass(1'500, line_, kOverHalf), 1'500U);
  EXPECT_EQ(Pass(600, telemetry_line_, kOverHalf), 500U);
  EXPECT_EQ(Pass(3'100, event_, kOverHalf), 3'000U) << "refused lines took nothing";
  clock_.Advance(seconds(1));
  EXPECT_EQ(Pass(60, line_, kOverHalf), 50U);
}

TEST(PongLimitTest, OneNameTakesNothingFromAnother) {
  testing::ManualClock clock;
  PongLimit limit;
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(limit.Take("a", clock.Steady()), i < kPongsOfNameMax);
  }
  EXPECT_TRUE(limit.Take("b", clock.Steady()));
  clock.Advance(milliseconds(999));
  EXPECT_FALSE(limit.Take("a", clock.Steady()));
  clock.Advance(milliseconds(1));
  EXPECT_TRUE(limit.Take("a", clock.Steady()));
}

TEST(TwinFaultRateTest, ChangesOfFaultsHaveARateOfTheirOwn) {
  testing::ManualClock clock;
  TwinRates rates;
  std::size_t changed = 0;
  while (!rates.LimitFaults(kRecordsOfMessageMax, clock.Steady())) changed += kRecordsOfMessageMax;
  EXPECT_LE(changed, kFaultChangesOfTwin.burst);
  EXPECT_GT(changed + kRecordsOfMessageMax, kFaultChangesOfTwin.burst);
  EXPECT_EQ(rates.LimitFaults(kRecordsOfMessageMax, clock.Steady())->reason,
            model::RejectReason::kRateLimited);
  clock.Advance(seconds(3));
  EXPECT_FALSE(rates.LimitFaults(kRecordsOfMessageMax, clock.Steady()).has_value());
}

TEST(PongLimitTest, ToAllNamesThereAreSoManyAndTheTableStaysBounded) {
  testing::ManualClock clock;
  PongLimit limit;
  std::size_t names = 0;
  std::size_t most = 0;
  for (int second = 0; second < 5; ++second) {
    std::size_t answered = 0;
    for (std::size_t i = 0; i < 3 * kPongsMax; ++i) {
      if (limit.Take(std::to_string(names++), clock.Steady())) ++answered;
      most = std::max(most, limit.names());
    }
    EXPECT_EQ(answered, kPongsMax);
    clock.Advance(seconds(1));
  }
  EXPECT_EQ(most, kPongNamesMax) << "it was full, and no fuller";
}

}  // namespace
}  // namespace uplink::cyberwave
