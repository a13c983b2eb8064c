#include "server/mqtt/reconnect.h"

#include <chrono>
#include <cstdint>
#include <optional>

#include <gtest/gtest.h>

namespace uplink::mqtt {
namespace {

using namespace std::chrono_literals;

constexpr ReconnectLimits kLimits{.backoff = {.first = 500ms, .longest = 8s},
                                  .early_within = 30s,
                                  .early_ends_max = 3,
                                  .taken_pause = 60s};

TEST(MqttReconnect, PausesGrowToTheLongestAndJitterInTheirUpperHalf) {
  Reconnect reconnect(kLimits);
  for (const milliseconds bound : {500ms, 1000ms, 2000ms, 4000ms, 8000ms, 8000ms}) {
    const auto pause = reconnect.After(EndReason::kConnect, std::nullopt, 12'345);
    EXPECT_GE(pause.wait, bound / 2);
    EXPECT_LE(pause.wait, bound);
    EXPECT_FALSE(pause.id_taken);
  }
}

TEST(MqttReconnect, AConnectionThatLivedBeginsWithAFirstPauseAgain) {
  Reconnect reconnect(kLimits);
  for (int i = 0; i < 6; ++i) {
    static_cast<void>(reconnect.After(EndReason::kConnect, std::nullopt, 0));
  }
  EXPECT_LE(reconnect.After(EndReason::kClosed, 30s, 0).wait, 500ms);
}

TEST(MqttReconnect, AConnectionThatWeEndedForBeingBehindIsMadeAgainSoon) {
  Reconnect reconnect(kLimits);
  for (int i = 0; i < 6; ++i) {
    const auto pause = reconnect.After(EndReason::kBehind, 10s, 0);
    EXPECT_LE(pause.wait, 500ms);
    EXPECT_FALSE(pause.id_taken);
  }
}

TEST(MqttReconnect, TheBrokerSaysThatAnotherClientHasOurId) {
  Reconnect reconnect(kLimits);
  const auto pause = reconnect.After(EndReason::kIdTaken, 1h, 0);
  EXPECT_TRUE(pause.id_taken);
  EXPECT_EQ(pause.wait, 60s);
  for (const std::uint64_t random : {1ULL, 6000ULL, 6001ULL, ~0ULL}) {
    const auto other = reconnect.After(EndReason::kIdTaken, 1h, random);
    EXPECT_GE(other.wait, 60s);
    EXPECT_LE(other.wait, 66s);
  }
}

TEST(MqttReconnect, AWordlessEndSoonAfterConnackIsTakenForThatAtTheThirdInARow) {
  Reconnect reconnect(kLimits);
  EXPECT_FALSE(reconnect.After(EndReason::kClosed, 1s, 0).id_taken);
  EXPECT_FALSE(reconnect.After(EndReason::kBroken, 2s, 0).id_taken);
  EXPECT_TRUE(reconnect.After(EndReason::kClosed, 29s, 0).id_taken);
  EXPECT_TRUE(reconnect.After(EndReason::kClosed, 1s, 0).id_taken) << "and so is each further one";
  EXPECT_FALSE(reconnect.After(EndReason::kClosed, 30s, 0).id_taken) << "this one lived";
  EXPECT_FALSE(reconnect.After(EndReason::kClosed, 1s, 0).id_taken);
}

TEST(MqttReconnect, AConnectionThatFailedInBetweenMeansThatTheBrokerWasAway) {
  Reconnect reconnect(kLimits);
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(reconnect.After(EndReason::kClosed, 1s, 0).id_taken);
    EXPECT_FALSE(reconnect.After(EndReason::kClosed, 1s, 0).id_taken);
    EXPECT_FALSE(reconnect.After(EndReason::kConnect, std::nullopt, 0).id_taken);
  }
}

TEST(MqttReconnect, AnEndWithAReasonIsNone) {
  Reconnect reconnect(kLimits);
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(reconnect.After(EndReason::kMalformed, 1s, 0).id_taken);
    EXPECT_FALSE(reconnect.After(EndReason::kDisconnected, 1s, 0).id_taken);
  }
}

}  // namespace
}  // namespace uplink::mqtt
