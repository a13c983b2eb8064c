// Which messages are known when the broker delivers them again.
#include "server/broker/redeliveries.h"

#include <vector>

#include <gtest/gtest.h>

namespace uplink::broker {
namespace {

using enum Redeliveries::Known;

storage::DeliveryDigest Digest(std::uint8_t of) { return {of}; }

TEST(Redeliveries, KnowWhatWaitsAndWhatWasCommitted) {
  Redeliveries known(4);
  const std::uint64_t number = known.NextNumber();
  known.AddWaiting({.number = number, .packet_id = 7, .digest = Digest(1)}, 3);
  EXPECT_EQ(known.Find(7, Digest(1)).known, kWaits);
  EXPECT_EQ(known.Find(7, Digest(1)).stream, 3U);
  EXPECT_EQ(known.Find(7, Digest(1)).number, number);
  EXPECT_EQ(known.Find(7, Digest(2)).known, kNo) << "another message has the id now";
  EXPECT_EQ(known.Find(8, Digest(1)).known, kNo);
  known.Commit(7, number);
  EXPECT_EQ(known.Find(7, Digest(1)).known, kSettled);
}

TEST(Redeliveries, ForgetWhatIsOlderThanTheyKeep) {
  Redeliveries known(2);
  for (std::uint16_t id = 1; id <= 2; ++id) {
    const std::uint64_t number = known.NextNumber();
    known.AddWaiting({.number = number, .packet_id = id, .digest = Digest(1)}, 3);
    known.Commit(id, number);
  }
  EXPECT_EQ(known.Find(1, Digest(1)).known, kSettled);
  known.AddSettled(3, Digest(1));
  EXPECT_EQ(known.Find(1, Digest(1)).known, kNo) << "one without a record has used an id too";
  EXPECT_EQ(known.Find(2, Digest(1)).known, kSettled);
}

TEST(Redeliveries, ANewMessageEndsWhatItsIdMeant) {
  Redeliveries known(4);
  const std::uint64_t first = known.NextNumber();
  known.AddWaiting({.number = first, .packet_id = 7, .digest = Digest(1)}, 3);
  const std::uint64_t second = known.NextNumber();
  known.AddWaiting({.number = second, .packet_id = 7, .digest = Digest(2)}, 4);
  known.Commit(7, first);
  EXPECT_EQ(known.Find(7, Digest(2)).known, kWaits) << "the commit was the older one's";
  known.End(7);
  EXPECT_EQ(known.Find(7, Digest(2)).known, kNo);
}

TEST(Redeliveries, ADroppedOneIsNewWhenItComesAgain) {
  Redeliveries known(4);
  const std::uint64_t number = known.NextNumber();
  known.AddWaiting({.number = number, .packet_id = 7, .digest = Digest(1)}, 3);
  known.Drop(7, number + 1);
  EXPECT_EQ(known.Find(7, Digest(1)).known, kWaits);
  known.Drop(7, number);
  EXPECT_EQ(known.Find(7, Digest(1)).known, kNo);
}

TEST(Redeliveries, BeginWithTheStoresMemoryAndKeepWhatWaits) {
  Redeliveries known(4);
  const std::uint64_t waits = known.NextNumber();
  known.AddWaiting({.number = waits, .packet_id = 7, .digest = Digest(1)}, 3);
  const std::uint64_t gone = known.NextNumber();
  known.AddWaiting({.number = gone, .packet_id = 9, .digest = Digest(9)}, 3);
  known.Commit(9, gone);
  known.Begin({.last_number = 50,
               .known = {{.number = 48, .packet_id = 7, .digest = Digest(2)},
                         {.number = 50, .packet_id = 8, .digest = Digest(3)}}});
  EXPECT_EQ(known.Find(7, Digest(1)).known, kWaits);
  EXPECT_EQ(known.Find(8, Digest(3)).known, kSettled);
  EXPECT_EQ(known.Find(9, Digest(9)).known, kNo) << "the store says what is committed";
  EXPECT_EQ(known.NextNumber(), 51U);
}

TEST(Redeliveries, IdsThatNobodyRemembersGoRoundToo) {
  Redeliveries known(2);
  const std::uint64_t number = known.NextNumber();
  known.AddWaiting({.number = number, .packet_id = 1, .digest = Digest(1)}, 3);
  known.Commit(1, number);
  known.End(2);
  EXPECT_EQ(known.Find(1, Digest(1)).known, kSettled);
  known.End(3);
  EXPECT_EQ(known.Find(1, Digest(1)).known, kNo);
}

TEST(Redeliveries, WhatWasSettledWithoutARecordGetsANumberOnce) {
  Redeliveries known(9);
  known.AddSettled(7, Digest(1));
  known.AddSettled(8, Digest(2));
  EXPECT_EQ(known.Find(7, Digest(1)).known, kSettled);
  // Another message has this id by now.
  known.AddSettled(8, Digest(3));
  const std::vector<storage::Delivery> settled{{.number = 0, .packet_id = 7, .digest = Digest(1)},
                                               {.number = 0, .packet_id = 8, .digest = Digest(2)}};
  const std::vector<storage::Delivery> numbered = known.Number(settled);
  ASSERT_EQ(numbered.size(), 1U);
  EXPECT_EQ(numbered[0], (storage::Delivery{.number = 1, .packet_id = 7, .digest = Digest(1)}));
  EXPECT_TRUE(known.Number(settled).empty());
}

TEST(Redeliveries, WhatWasSettledWithoutARecordIsKnownUnderTheSameLeaseAlone) {
  Redeliveries known(9);
  known.AddSettled(7, Digest(1));
  known.AddSettled(8, Digest(2));
  // It has a number, and the store never got it.
  static_cast<void>(known.Number({{.number = 0, .packet_id = 8, .digest = Digest(2)}}));
  known.Reread({.last_number = 5, .known = {}});
  EXPECT_EQ(known.Find(7, Digest(1)).known, kSettled);
  EXPECT_EQ(known.Find(8, Digest(2)).known, kNo);
  known.Begin({.last_number = 5, .known = {}});
  EXPECT_EQ(known.Find(7, Digest(1)).known, kNo);
}

TEST(Redeliveries, ALostSessionEndsAll) {
  Redeliveries known(4);
  known.AddWaiting({.number = known.NextNumber(), .packet_id = 7, .digest = Digest(1)}, 3);
  const storage::Delivery end = known.EndSession();
  EXPECT_EQ(end.packet_id, 0U);
  EXPECT_EQ(end.number, 2U);
  EXPECT_FALSE(end.digest.has_value());
  EXPECT_EQ(known.Find(7, Digest(1)).known, kNo);
}

}  // namespace
}  // namespace uplink::broker
