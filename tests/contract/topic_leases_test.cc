#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/contract/topic_contract.h"

/// Which process has the lease of a topic, and what is fenced for it.
namespace uplink::testing {
namespace {

using storage::OutcomeKind;
using storage::TopicLease;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class TopicLeaseContract : public TopicContract {};

TEST_P(TopicLeaseContract, TheFirstThatAsksHasItAndIsToldSoAgain) {
  EXPECT_THAT(Read(), IsEmpty());
  const auto epoch = Take(Wants({"b", ""}));
  ASSERT_TRUE(epoch);
  EXPECT_GT(*epoch, 0U);
  storage::TakeRequest later = Wants({"", "b"});
  later.at = Time(1'000);
  EXPECT_EQ(Take(later), epoch) << "an answer that was lost, or a prefix less";
  EXPECT_THAT(Read(),
              ElementsAre(TopicLease{
                  "uplinkd", {"", "b"}, *epoch, storage::ProcessId{kProcess}, false, Time()}));
  EXPECT_EQ(Take(Wants({"c"})), epoch);
  ASSERT_THAT(Read(), SizeIs(1));
  EXPECT_THAT(Read()[0].prefixes, ElementsAre("c"));
}

TEST_P(TopicLeaseContract, NobodyElseGetsItsClientIdOrOneOfItsPrefixes) {
  const auto epoch = Take(Wants({"a", "b"}));
  const std::vector<TopicLease> before = Read();
  EXPECT_EQ(Take(Wants({"a", "b"}), kOther), std::nullopt);
  EXPECT_EQ(Take(Wants({"c"}), kOther), std::nullopt) << "its client id";
  EXPECT_EQ(Take(Wants({"c", "b"}, "other"), kOther), std::nullopt) << "all or nothing";
  EXPECT_EQ(Read(), before);
  EXPECT_EQ(Take(Wants({"a", "b"})), epoch);
  EXPECT_NE(Take(Wants({"c"}, "other"), kOther), std::nullopt) << "what is free";
}

TEST_P(TopicLeaseContract, ItIsFreeOnceItWasReleased) {
  const auto epoch = Take(Wants());
  ASSERT_TRUE(Leases(kOther).Release("uplinkd").ok()) << "not its own";
  EXPECT_EQ(Take(Wants(), kOther), std::nullopt);
  ASSERT_TRUE(Leases().Release("uplinkd").ok());
  ASSERT_TRUE(Leases().Release("uplinkd").ok()) << "again";
  ASSERT_TRUE(Leases().Release("unknown").ok());
  ASSERT_THAT(Read(), SizeIs(1));
  EXPECT_TRUE(Read()[0].released);
  EXPECT_THAT(Read()[0].prefixes, IsEmpty());
  const auto taken = Take(Wants(), kOther);
  ASSERT_TRUE(taken);
  EXPECT_GT(*taken, *epoch);
  EXPECT_EQ(Take(Wants()), std::nullopt);
}

TEST_P(TopicLeaseContract, OneThatIsTakenAnewHasAnotherEpoch) {
  const auto first = Take(Wants());
  ASSERT_TRUE(Leases().Release("uplinkd").ok());
  const auto second = Take(Wants());
  ASSERT_TRUE(second);
  EXPECT_GT(*second, *first);
  EXPECT_GT(Open().epoch, *second) << "one sequence for robots and topics";
}

TEST_P(TopicLeaseContract, WhoJudgedItsHolderOverTakesIt) {
  Open();
  const auto epoch = Take(Wants({"a", "b"}));
  EXPECT_EQ(Take(After(7, Wants({"a", "b"})), kOther), std::nullopt) << "another is over";
  const auto taken = Take(After(kProcess, Wants({"a", "b"})), kOther);
  ASSERT_TRUE(taken);
  EXPECT_GT(*taken, *epoch);
  ASSERT_THAT(Read(), SizeIs(1));
  EXPECT_EQ(Read()[0].holder, storage::ProcessId{kOther});
  EXPECT_EQ(Take(Wants({"a", "b"})), std::nullopt) << "who was judged over lost it";
  EXPECT_THAT(Commit({Under(Hold(epoch), Good(1)), Good(1)}),
              ElementsAre(OutcomeKind::kFenced, OutcomeKind::kStored));
}

TEST_P(TopicLeaseContract, OneWhoseHolderRenewedItsLeaseSinceIsNotTaken) {
  storage::Leases* const mine = store_->LeasesOf(kProcess);
  if (mine == nullptr) return;  // one process has the store at a time
  const storage::ProcessCard card{"a:1", "life"};
  ASSERT_TRUE(mine->Renew(card).ok());
  const auto epoch = Take(Wants());
  ASSERT_TRUE(mine->Renew(card).ok());
  EXPECT_EQ(Take(After(kProcess, Wants(), 1), kOther), std::nullopt);
  EXPECT_EQ(Take(Wants()), epoch);
  EXPECT_NE(Take(After(kProcess, Wants(), 2), kOther), std::nullopt);
}

TEST_P(TopicLeaseContract, ALeaseThatLosesOnePrefixEndsWhole) {
  Open();
  const auto old = Take(Wants({"a", "b"}, "old"));
  const auto taken = Take(After(kProcess, Wants({"b"}, "new")), kOther);
  ASSERT_TRUE(taken);
  const auto leases = Read();
  ASSERT_THAT(leases, SizeIs(2));
  EXPECT_EQ(leases[0].client_id, "new");
  EXPECT_THAT(leases[0].prefixes, ElementsAre("b"));
  EXPECT_TRUE(leases[1].released);
  EXPECT_THAT(leases[1].prefixes, IsEmpty());
  EXPECT_THAT(Commit({Under(Hold(old, "old"), Good(1))}), Each(OutcomeKind::kFenced));
  EXPECT_NE(Take(Wants({"a"}, "third"), 3), std::nullopt) << "its other prefix is free";
}

TEST_P(TopicLeaseContract, OfTwoThatTryAtOnceOneSucceeds) {
  Take(Wants());
  const auto first = Take(After(kProcess, Wants()), kOther);
  const auto second = Take(After(kProcess, Wants()), 3);
  EXPECT_TRUE(first);
  EXPECT_EQ(second, std::nullopt);
}

TEST_P(TopicLeaseContract, WhatCameUnderALeaseThatStandsIsStored) {
  Open();
  const auto epoch = Take(Wants());
  EXPECT_THAT(Commit({Under(Hold(epoch), Good(1)), Under(nullptr, Good(2))}),
              Each(OutcomeKind::kStored));
  ASSERT_TRUE(Leases().Release("uplinkd").ok());
  EXPECT_THAT(Commit({Under(Hold(epoch), Good(3))}), Each(OutcomeKind::kStored))
      << "released, and not taken";
}

TEST_P(TopicLeaseContract, NothingIsWrittenOfWhatCameUnderALeaseThatIsOver) {
  Open();
  const auto stale = Take(Wants());
  const auto taken = Take(After(kProcess, Wants()), kOther);
  storage::Batch batch;
  batch.records = {Under(Hold(stale), Good(1)), Under(Hold(stale), Bad(2)), Good(3),
                   Under(Hold(stale, "never"), Good(4)), Under(Hold(taken), Good(5))};
  batch.records[0].message_end =
      storage::MessageEnd{.deliveries = {{1, 7, storage::DeliveryDigest{1}}}};
  batch.deliveries = {{Hold(stale), {{2, 8, storage::DeliveryDigest{2}}}}};
  std::vector<OutcomeKind> kinds;
  for (const storage::Outcome& outcome : Commit(batch)) kinds.push_back(outcome.kind);
  EXPECT_THAT(kinds, ElementsAre(OutcomeKind::kFenced, OutcomeKind::kFenced, OutcomeKind::kStored,
                                 OutcomeKind::kFenced, OutcomeKind::kFenced))
      << "the last came under a lease that stands, and is another's";
  EXPECT_THAT(Messages(), SizeIs(1));
  EXPECT_THAT(Quarantine(), IsEmpty());
  EXPECT_THAT(Memory().known, IsEmpty());
  EXPECT_EQ(CursorNow(), 3U);
}

TEST_P(TopicLeaseContract, AnotherProcessWithTheSameEpochIsFenced) {
  // Two processes are given one epoch by a store that went back between.
  const auto epoch = Take(Wants());
  Open(Request(), kOther);
  EXPECT_THAT(Commit({Under(Hold(epoch), Good(1)), Good(2)}, kOther),
              ElementsAre(OutcomeKind::kFenced, OutcomeKind::kStored));
}

TEST_P(TopicLeaseContract, TheLeaseIsLookedAtWhereTheDatabaseRefusesARecordToo) {
  Open();
  store_->RefuseFault("poison");
  const auto stale = Take(Wants());
  Take(After(kProcess, Wants()), kOther);
  EXPECT_THAT(Commit({Under(Hold(stale), Good(1)), Good(2, Fault("poison")), Good(3)}),
              ElementsAre(OutcomeKind::kFenced, OutcomeKind::kRefused, OutcomeKind::kStored));
}

TEST_P(TopicLeaseContract, ABadRequestIsRefusedByFieldAndLimit) {
  const auto text = [this](const storage::TakeRequest& request) {
    const absl::Status status = Leases().Take(request).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return std::string(status.message());
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(text(Wants({""}, "")), HasSubstr("client_id"));
  EXPECT_THAT(text(Wants({""}, std::string(storage::kClientIdBytesMax + 1, 'x'))),
              HasSubstr("outside 1 to 256"));
  EXPECT_THAT(text(Wants({})), HasSubstr("prefixes"));
  EXPECT_THAT(text(Wants({"1", "2", "3", "4", "5", "6", "7", "8", "9"})),
              HasSubstr("9 items, outside 1 to 8"));
  EXPECT_THAT(text(Wants({"a", "b", "a"})), HasSubstr("\"a\" twice"));
  const std::string longest(storage::kTopicPrefixBytesMax, 'p');
  EXPECT_THAT(text(Wants({"a", longest + "p"})),
              HasSubstr("prefixes[1] has 256 bytes, more than 255"));
  storage::TakeRequest request = Wants();
  request.unacked_max = 0;
  EXPECT_THAT(text(request), HasSubstr("unacked_max is 0, outside 1 to 32767"));
  request.unacked_max = storage::kUnackedMaxMax + 1;
  EXPECT_THAT(text(request), HasSubstr("unacked_max is 32768"));
  EXPECT_THAT(Read(), IsEmpty());
  EXPECT_NE(Take(Wants({"1", "2", "3", "4", "5", "6", "7", longest},
                       std::string(storage::kClientIdBytesMax, 'x'))),
            std::nullopt);
}

TEST_P(TopicLeaseContract, ClientIdsThatNobodyHoldsAreBounded) {
  const auto name = [](std::size_t i) { return "client-" + std::to_string(1'000 + i); };
  for (std::size_t i = 0; i <= storage::kTopicClientsMax + 1; ++i) {
    storage::TakeRequest request = Wants({"p" + std::to_string(i)}, name(i));
    request.at = Time(static_cast<std::int64_t>(i));
    ASSERT_TRUE(Take(request));
    // The first is held all the time.
    if (i == 0) continue;
    ASSERT_TRUE(Leases().Release(name(i)).ok());
  }
  const auto leases = Read();
  ASSERT_THAT(leases, SizeIs(storage::kTopicClientsMax));
  EXPECT_EQ(leases[0].client_id, name(0));
  EXPECT_EQ(leases[1].client_id, name(3));
}

INSTANTIATE_TEST_SUITE_P(Stores, TopicLeaseContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
