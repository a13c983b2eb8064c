#include "server/mqtt/unacked.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::mqtt {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// The handle of a message that is delivered.
AckHandle Deliver(Unacked& unacked, PacketId id, bool dup = false) {
  return unacked.Add(id, dup).handle.value_or(AckHandle{});
}

TEST(MqttUnacked, AcksInTheOrderOfArrivalWhateverTheOrderOfRelease) {
  Unacked unacked(1, 8);
  const AckHandle first = Deliver(unacked, 10);
  const AckHandle second = Deliver(unacked, 11);
  const AckHandle third = Deliver(unacked, 12);
  EXPECT_THAT(unacked.Release(third), IsEmpty());
  EXPECT_THAT(unacked.Release(second), IsEmpty());
  EXPECT_EQ(unacked.size(), 3U);
  EXPECT_THAT(unacked.Release(first), ElementsAre(10, 11, 12));
  EXPECT_EQ(unacked.size(), 0U);
}

TEST(MqttUnacked, IsFullAtItsBoundAndHasRoomAfterAnAck) {
  Unacked unacked(1, 2);
  const AckHandle first = Deliver(unacked, 1);
  EXPECT_FALSE(unacked.full());
  const AckHandle second = Deliver(unacked, 2);
  EXPECT_TRUE(unacked.full());
  EXPECT_THAT(unacked.Release(second), IsEmpty());
  EXPECT_TRUE(unacked.full()) << "released, and not acked yet";
  EXPECT_THAT(unacked.Release(first), ElementsAre(1, 2));
  EXPECT_FALSE(unacked.full());
}

TEST(MqttUnacked, AHandleOfAnotherConnectionDoesNothing) {
  Unacked older(1, 8);
  const AckHandle stale = Deliver(older, 5);
  Unacked unacked(2, 8);
  const AckHandle own = Deliver(unacked, 5, true);
  EXPECT_THAT(unacked.Release(stale), IsEmpty());
  EXPECT_TRUE(unacked.Holds(own));
  EXPECT_THAT(unacked.Release(own), ElementsAre(5));
}

TEST(MqttUnacked, ASecondReleaseDoesNothing) {
  Unacked unacked(1, 8);
  const AckHandle first = Deliver(unacked, 1);
  const AckHandle second = Deliver(unacked, 2);
  EXPECT_THAT(unacked.Release(second), IsEmpty());
  EXPECT_THAT(unacked.Release(second), IsEmpty());
  EXPECT_THAT(unacked.Release(first), ElementsAre(1, 2));
  EXPECT_THAT(unacked.Release(first), IsEmpty());
  EXPECT_THAT(unacked.Release({1, 1000}), IsEmpty());
}

TEST(MqttUnacked, ARedeliveryHasThePlaceOfTheFirstAndOneAck) {
  Unacked unacked(1, 8);
  const Unacked::Delivery first = unacked.Add(1, false);
  const AckHandle second = Deliver(unacked, 2);
  const Unacked::Delivery again = unacked.Add(1, true);
  EXPECT_TRUE(again.again);
  EXPECT_EQ(again.handle, first.handle);
  EXPECT_EQ(unacked.size(), 2U);
  EXPECT_THAT(unacked.Release(*again.handle), ElementsAre(1));
  EXPECT_THAT(unacked.Release(*first.handle), IsEmpty()) << "a second PUBACK could ack another one";
  EXPECT_THAT(unacked.Release(second), ElementsAre(2));
}

TEST(MqttUnacked, ADupOfWhatThisConnectionAckedIsNoDelivery) {
  Unacked unacked(1, 8);
  EXPECT_THAT(unacked.Release(Deliver(unacked, 1)), ElementsAre(1));
  for (int i = 0; i < 2; ++i) {
    const Unacked::Delivery crossed = unacked.Add(1, true);
    EXPECT_TRUE(crossed.again);
    EXPECT_FALSE(crossed.handle) << "a second PUBACK could ack another one";
  }
  EXPECT_EQ(unacked.size(), 0U);
}

TEST(MqttUnacked, AnIdThatWasAckedAndComesWithoutDupIsAnotherMessages) {
  Unacked unacked(1, 8);
  for (int i = 0; i < 3; ++i) {
    const Unacked::Delivery other = unacked.Add(1, false);
    EXPECT_FALSE(other.again);
    ASSERT_TRUE(other.handle);
    EXPECT_EQ(unacked.Add(1, true).handle, other.handle);
    EXPECT_THAT(unacked.Release(*other.handle), ElementsAre(1));
    EXPECT_FALSE(unacked.Add(1, true).handle);
  }
}

TEST(MqttUnacked, ADupThatThisConnectionDidNotAckIsADelivery) {
  Unacked unacked(2, 8);
  EXPECT_THAT(unacked.Release(Deliver(unacked, 65'535)), ElementsAre(65'535));
  const Unacked::Delivery older = unacked.Add(1, true);
  EXPECT_FALSE(older.again);
  ASSERT_TRUE(older.handle);
  EXPECT_THAT(unacked.Release(*older.handle), ElementsAre(1));
  EXPECT_FALSE(unacked.Add(1, true).handle) << "and is acked once";
}

TEST(MqttUnacked, AnIdThatWentToAnotherMessageAcksThatOneOnly) {
  Unacked unacked(1, 8);
  // A PUBACK crossed with this resending, so the broker is done with it, and gives its id away.
  const AckHandle crossed = Deliver(unacked, 1, true);
  const Unacked::Delivery other = unacked.Add(1, false);
  EXPECT_FALSE(other.again);
  EXPECT_NE(other.handle, crossed);
  EXPECT_THAT(unacked.Release(crossed), IsEmpty()) << "it would ack the other one unstored";
  EXPECT_THAT(unacked.Release(*other.handle), ElementsAre(1));
  EXPECT_EQ(unacked.size(), 0U);
}

TEST(MqttUnackedDeathTest, ReadingPastTheWindowIsOurMistake) {
  Unacked unacked(1, 1);
  static_cast<void>(unacked.Add(1, false));
  EXPECT_DEATH(static_cast<void>(unacked.Add(2, false)), "past the window");
}

}  // namespace
}  // namespace uplink::mqtt
