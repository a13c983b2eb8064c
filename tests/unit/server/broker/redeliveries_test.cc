// Which messages are known when the broker delivers them again.
#include "server/broker/redeliveries.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::broker {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
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
  known.AddSettled(3, Digest(1), {.stream = 0});
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
  known.Expire(7);
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

TEST(Redeliveries, WhatAStoreThatWentBackLacksIsNewUnlessItWasCommittedSince) {
  Redeliveries known(8);
  const auto commit = [&known](std::uint16_t id) {
    const std::uint64_t number = known.NextNumber();
    known.AddWaiting({.number = number, .packet_id = id, .digest = Digest(1)}, 3);
    known.Commit(id, number);
  };
  commit(1);
  commit(2);
  known.BeginReread();
  commit(3);
  // Read before 3 was committed, and after 2 was lost.
  known.Reread({.last_number = 1, .known = {{.number = 1, .packet_id = 1, .digest = Digest(1)}}});
  EXPECT_EQ(known.Find(1, Digest(1)).known, kSettled);
  EXPECT_EQ(known.Find(2, Digest(1)).known, kNo);
  EXPECT_EQ(known.Find(3, Digest(1)).known, kSettled);
  known.BeginReread();
  known.Reread({.last_number = 1, .known = {{.number = 1, .packet_id = 1, .digest = Digest(1)}}});
  EXPECT_EQ(known.Find(3, Digest(1)).known, kNo) << "by the next time the store should have it";
}

/// Its number goes with the records of a later message, which may be under way when the store is
/// read again: forgotten, it would be stored anew.
TEST(Redeliveries, OneWithoutARecordIsKnownThoughItsNumberIsNotCommittedYet) {
  Redeliveries known(9);
  known.AddSettled(7, Digest(1), {.stream = 3});
  EXPECT_EQ(known.Number(3, {7}).size(), 1U);
  known.BeginReread();
  known.Reread({.last_number = 0, .known = {}});
  EXPECT_EQ(known.Find(7, Digest(1)).known, kSettled);
}

TEST(Redeliveries, OneWithoutARecordIsNewIfTheStoreLostTheCommitThatBroughtIt) {
  Redeliveries known(9);
  known.AddSettled(7, Digest(1), {.stream = 3});
  known.AddSettled(8, Digest(2), {.stream = 3});
  const std::vector<storage::Delivery> brought = known.Number(3, {7});
  known.Commit(7, brought.at(0).number);
  known.BeginReread();
  known.Reread({.last_number = 0, .known = {}});
  EXPECT_EQ(known.Find(7, Digest(1)).known, kNo) << "what it went with is new, and comes after it";
  EXPECT_EQ(known.Find(8, Digest(2)).known, kSettled) << "it was never the store's";
}

TEST(Redeliveries, OneWithoutARecordThatRestsOnTheStoreIsNewOnceTheStoreIsReadAgain) {
  Redeliveries known(9);
  const std::uint64_t stored = known.NextNumber();
  known.AddWaiting({.number = stored, .packet_id = 7, .digest = Digest(1)}, 3);
  known.Commit(7, stored);
  known.AddSettled(7, Digest(2), {.stream = 3, .rests_on = 1});
  known.AddSettled(8, Digest(2), {.stream = 3, .rests_on = 1});
  known.AddSettled(9, Digest(3), {.stream = 3});
  EXPECT_EQ(known.Find(7, Digest(2)).rests_on, 1U);
  EXPECT_EQ(known.Number(3, {8}).size(), 1U);
  EXPECT_EQ(known.Find(8, Digest(2)).rests_on, 1U);
  known.BeginReread();
  known.Reread(
      {.last_number = stored, .known = {{.number = stored, .packet_id = 7, .digest = Digest(1)}}});
  EXPECT_EQ(known.Find(7, Digest(2)).known, kNo);
  EXPECT_EQ(known.Find(7, Digest(1)).known, kNo) << "another message has had the id since";
  EXPECT_EQ(known.Find(8, Digest(2)).known, kSettled) << "its number goes with a commit under way";
  EXPECT_EQ(known.Find(9, Digest(3)).known, kSettled) << "it is so whatever the store has";
  std::vector<std::uint16_t> ids{7, 9};
  known.KeepSettled(3, ids);
  EXPECT_THAT(ids, ElementsAre(9));
}

TEST(Redeliveries, OneWithoutARecordIsNewIfItsStreamIsLost) {
  Redeliveries known(9);
  known.AddSettled(7, Digest(1), {.stream = 3});
  known.AddSettled(8, Digest(2), {.stream = 3});
  known.AddSettled(9, Digest(3), {.stream = 4});
  const std::vector<storage::Delivery> brought = known.Number(3, {7});
  known.Drop(7, brought.at(0).number);
  known.DropSettled(3, {7, 8, 9});
  EXPECT_EQ(known.Find(7, Digest(1)).known, kNo);
  EXPECT_EQ(known.Find(8, Digest(2)).known, kNo);
  EXPECT_EQ(known.Find(9, Digest(3)).known, kSettled) << "another twin's";
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
  known.Expire(2);
  EXPECT_EQ(known.Find(1, Digest(1)).known, kSettled);
  known.Expire(3);
  EXPECT_EQ(known.Find(1, Digest(1)).known, kNo);
}

TEST(Redeliveries, WhatWasSettledWithoutARecordGetsANumberOnce) {
  Redeliveries known(9);
  known.AddSettled(8, Digest(2), {.stream = 3});
  known.AddSettled(7, Digest(1), {.stream = 3});
  known.AddSettled(9, Digest(4), {.stream = 4});
  EXPECT_EQ(known.Find(7, Digest(1)).known, kSettled);
  // Another message of the same twin has this id by now, and one of another twin that one.
  known.AddSettled(8, Digest(3), {.stream = 3});
  known.AddSettled(10, Digest(5), {.stream = 3});
  known.AddSettled(10, Digest(5), {.stream = 4});
  EXPECT_THAT(known.Number(3, {8, 7, 9, 8, 10}),
              ElementsAre(storage::Delivery{.number = 1, .packet_id = 7, .digest = Digest(1)},
                          storage::Delivery{.number = 2, .packet_id = 8, .digest = Digest(3)}));
  EXPECT_THAT(known.Number(3, {8, 7}), IsEmpty());
}

TEST(Redeliveries, OfWhatWasSettledWithoutARecordTheOldIsNotRemembered) {
  Redeliveries known(2);
  for (std::uint16_t id = 1; id <= 3; ++id) known.AddSettled(id, Digest(1), {.stream = 3});
  std::vector<std::uint16_t> ids{1, 2, 3};
  known.KeepSettled(3, ids);
  EXPECT_THAT(ids, ElementsAre(2, 3));
}

TEST(Redeliveries, WhatWasSettledWithoutARecordIsKnownUnderTheSameLeaseAlone) {
  Redeliveries known(9);
  known.AddSettled(7, Digest(1), {.stream = 3});
  known.AddSettled(8, Digest(2), {.stream = 3});
  // It has a number, and the store has not got it yet.
  static_cast<void>(known.Number(3, {8}));
  known.Reread({.last_number = 5, .known = {}});
  EXPECT_EQ(known.Find(7, Digest(1)).known, kSettled);
  EXPECT_EQ(known.Find(8, Digest(2)).known, kSettled);
  known.Begin({.last_number = 5, .known = {}});
  EXPECT_EQ(known.Find(7, Digest(1)).known, kNo);
}

TEST(Redeliveries, SayWhatIsOverThatTheStoreKnows) {
  Redeliveries known(9);
  const auto commit = [&known](std::uint16_t id) {
    const std::uint64_t number = known.NextNumber();
    known.AddWaiting({.number = number, .packet_id = id, .digest = Digest(1)}, 3);
    known.Commit(id, number);
  };
  for (std::uint16_t id = 1; id <= 4; ++id) commit(id);
  EXPECT_THAT(known.TakeExpired(), IsEmpty());
  known.AddSettled(1, Digest(2), {.stream = 3});
  known.AddSettled(1, Digest(3), {.stream = 3});
  known.Expire(2);
  // These are remembered themselves.
  known.AddSettled(3, Digest(2), {.stream = 3});
  static_cast<void>(known.Number(3, {3}));
  known.Expire(4);
  commit(4);
  EXPECT_THAT(known.TakeExpired(),
              ElementsAre(storage::Delivery{.number = 7, .packet_id = 1, .digest = {}},
                          storage::Delivery{.number = 8, .packet_id = 2, .digest = {}}));
  EXPECT_THAT(known.TakeExpired(), IsEmpty());
  // The store does not know it yet, and says what it knew.
  known.Reread({.last_number = 6,
                .known = {{.number = 1, .packet_id = 1, .digest = Digest(1)},
                          {.number = 2, .packet_id = 2, .digest = Digest(1)}}});
  EXPECT_EQ(known.Find(1, Digest(1)).known, kNo);
  EXPECT_EQ(known.Find(1, Digest(3)).known, kSettled);
  EXPECT_EQ(known.Find(2, Digest(1)).known, kNo);
}

TEST(Redeliveries, WhatWaitsWhenItsIdIsTakenIsOverToo) {
  Redeliveries known(9);
  known.AddWaiting({.number = known.NextNumber(), .packet_id = 7, .digest = Digest(1)}, 3);
  known.Expire(7);
  EXPECT_THAT(known.TakeExpired(),
              ElementsAre(storage::Delivery{.number = 2, .packet_id = 7, .digest = {}}))
      << "it counts more than what is committed later";
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
