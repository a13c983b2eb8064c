// Streams of twins that end, go on, and lie idle.
#include "server/broker/twin_streams.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/broker/limits.h"
#include "tests/unit/server/broker/broker_bench.h"

namespace uplink::broker {
namespace {

using ::testing::ElementsAre;

model::cyberwave::Uuid IdOf(const char* twin) { return *model::cyberwave::Uuid::FromText(twin); }

class TwinStreamsTest : public ::testing::Test {
 protected:
  TwinStreamsTest() { EXPECT_TRUE(bench_.TakeLease()); }
  ~TwinStreamsTest() override { EXPECT_TRUE(bench_.ledger.Read().messages.Balanced()); }

  void Publish(int number, std::uint64_t handle) {
    EXPECT_EQ(bench_.Publish(Bench::Of("telemetry"), Bench::Event(number),
                             {.id = static_cast<std::uint16_t>(number), .handle = handle}),
              Intake::Processed::kDone);
  }
  [[nodiscard]] TwinStreams::Opened Open() {
    return bench_.streams.FindOrOpen({.ruri = RuriOf(kTwin), .prefix = "", .twin = IdOf(kTwin)});
  }

  testing::FakeDatabase database_;
  Bench bench_{database_, 1, {.twins_max = 1}};
};

TEST_F(TwinStreamsTest, OneThatWasToEndGoesOnWithWhatItsTwinSaysNext) {
  Publish(1, 11);
  bench_.streams.EndAll();
  bench_.twins.Clear();
  Publish(2, 12);
  EXPECT_NE(bench_.twins.Find(RuriOf(kTwin)), nullptr);
  EXPECT_EQ(bench_.streams.size(), 1U);
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U, 12U));
  EXPECT_EQ(bench_.streams.size(), 1U);
}

TEST_F(TwinStreamsTest, OneThatWasToEndEndsWhereAnotherTwinHasItsPlaceByNow) {
  Publish(1, 11);
  bench_.streams.EndAll();
  bench_.twins.Clear();
  ASSERT_NE(bench_.twins.FindOrAdd(RuriOf(kOtherTwin), IdOf(kOtherTwin)), nullptr);
  EXPECT_TRUE(Open().too_many);
  (void)bench_.Publish(Bench::Of("position"), R"({"position":{"x":1,"y":2,"z":3}})");
  EXPECT_EQ(bench_.Count(Became::kRefused), 1U);
  EXPECT_EQ(bench_.twins.bytes(), 0U) << "what the old stream's twin had said is gone";
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U));
  EXPECT_EQ(bench_.streams.size(), 0U);
}

TEST_F(TwinStreamsTest, OneThatSaidNothingForLongIsClosedAndOpenedAgain) {
  Publish(1, 11);
  bench_.Run();
  bench_.clock.Advance(kStreamIdleMax - milliseconds(1));
  bench_.streams.CloseIdle();
  EXPECT_EQ(bench_.streams.size(), 1U);
  bench_.clock.Advance(milliseconds(1));
  bench_.streams.CloseIdle();
  EXPECT_EQ(bench_.streams.size(), 0U);
  Publish(2, 12);
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U, 12U));
}

TEST_F(TwinStreamsTest, OneWhoseMessageWaitsIsNotIdle) {
  Publish(1, 11);
  bench_.clock.Advance(2 * kStreamIdleMax);
  bench_.streams.CloseIdle();
  EXPECT_EQ(bench_.streams.size(), 1U);
  bench_.Run();
}

}  // namespace
}  // namespace uplink::broker
