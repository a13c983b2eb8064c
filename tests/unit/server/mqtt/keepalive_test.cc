#include "server/mqtt/keepalive.h"

#include <chrono>

#include <gtest/gtest.h>

namespace uplink::mqtt {
namespace {

using namespace std::chrono_literals;
using Due = Keepalive::Due;

constexpr SteadyTime kStart{1h};

TEST(MqttKeepalive, PingsEachIntervalWhateverIsSentAndComes) {
  Keepalive keepalive(60s, 15s, kStart);
  keepalive.NoteHeard(kStart + 50s);
  EXPECT_EQ(keepalive.Next(), kStart + 60s);
  EXPECT_EQ(keepalive.At(kStart + 59s), Due::kNothing);
  EXPECT_EQ(keepalive.At(kStart + 60s), Due::kPing);
  keepalive.Sent(kStart + 30s);
  EXPECT_EQ(keepalive.At(kStart + 60s), Due::kPing);
  keepalive.Pinged(kStart + 60s);
  keepalive.Ponged();
  EXPECT_EQ(keepalive.Next(), kStart + 120s);
}

TEST(MqttKeepalive, TellsHowLongAPingWaitsThoughOtherBytesCome) {
  Keepalive keepalive(60s, 15s, kStart);
  EXPECT_EQ(keepalive.Waited(kStart + 60s), 0s);
  keepalive.Pinged(kStart + 60s);
  keepalive.NoteHeard(kStart + 69s);
  keepalive.Pinged(kStart + 120s);
  EXPECT_EQ(keepalive.Waited(kStart + 121s), 61s);
  keepalive.StopReading();
  EXPECT_EQ(keepalive.Waited(kStart + 122s), 0s);
  keepalive.ReadAgain(kStart + 130s);
  EXPECT_EQ(keepalive.Waited(kStart + 131s), 1s);
  keepalive.Ponged();
  EXPECT_EQ(keepalive.Waited(kStart + 131s), 0s);
}

TEST(MqttKeepalive, PingsOnceNothingCameThoughWeSend) {
  Keepalive keepalive(60s, 15s, kStart);
  keepalive.Sent(kStart + 59s);
  EXPECT_EQ(keepalive.At(kStart + 60s), Due::kPing);
}

TEST(MqttKeepalive, NoPingrespIsLateAfterTheWait) {
  Keepalive keepalive(60s, 15s, kStart);
  keepalive.Pinged(kStart + 60s);
  EXPECT_EQ(keepalive.Next(), kStart + 75s);
  EXPECT_EQ(keepalive.At(kStart + 74s), Due::kNothing);
  EXPECT_EQ(keepalive.At(kStart + 75s), Due::kLate);
  keepalive.NoteHeard(kStart + 74s);
  keepalive.Ponged();
  EXPECT_EQ(keepalive.At(kStart + 75s), Due::kNothing);
}

TEST(MqttKeepalive, BytesThatComeAreASignOfLife) {
  Keepalive keepalive(60s, 15s, kStart);
  keepalive.Pinged(kStart + 60s);
  keepalive.NoteHeard(kStart + 74s);
  EXPECT_EQ(keepalive.At(kStart + 88s), Due::kNothing);
  EXPECT_EQ(keepalive.At(kStart + 89s), Due::kLate);
}

TEST(MqttKeepalive, NothingIsLateWhileWeDoNotReadAndTheWaitBeginsAnewAfterIt) {
  Keepalive keepalive(60s, 15s, kStart);
  keepalive.StopReading();
  EXPECT_EQ(keepalive.At(kStart + 60s), Due::kPing) << "the broker counts on it";
  keepalive.Pinged(kStart + 60s);
  EXPECT_EQ(keepalive.At(kStart + 100s), Due::kNothing);
  EXPECT_EQ(keepalive.At(kStart + 120s), Due::kPing);
  keepalive.Pinged(kStart + 120s);
  keepalive.ReadAgain(kStart + 170s);
  EXPECT_EQ(keepalive.At(kStart + 179s), Due::kNothing);
  EXPECT_EQ(keepalive.At(kStart + 185s), Due::kLate);
}

TEST(MqttKeepalive, TheBrokersIntervalIsObeyedUnlessItIsNoneOrLonger) {
  Keepalive keepalive(60s, 15s, kStart);
  keepalive.SetInterval(0s);
  EXPECT_EQ(keepalive.interval(), 60s);
  keepalive.SetInterval(10s);
  EXPECT_EQ(keepalive.At(kStart + 10s), Due::kPing);
  keepalive.SetInterval(600s);
  EXPECT_EQ(keepalive.At(kStart + 10s), Due::kPing)
      << "a broker that is silent is found out in time";
}

}  // namespace
}  // namespace uplink::mqtt
