// Messages that come again, and robots that another process takes.
#include "server/broker/commits.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/broker/broker_bench.h"

namespace uplink::broker {
namespace {

using ::testing::ElementsAre;
using testing::FailAt;
using ::testing::IsEmpty;

class CommitsTest : public ::testing::Test {
 protected:
  CommitsTest() { EXPECT_TRUE(bench_.TakeLease()); }
  ~CommitsTest() override { EXPECT_TRUE(bench_.ledger.Read().messages.Balanced()); }

  static void Publish(Bench& bench, int number, const Bench::Options& options) {
    EXPECT_EQ(bench.Publish(Bench::Of("telemetry"), Bench::Event(number), options),
              Intake::Processed::kDone);
  }
  [[nodiscard]] std::size_t Stored() { return bench_.store.Events({})->rows.size(); }

  testing::FakeDatabase database_;
  Bench bench_{database_, 1};
};

TEST_F(CommitsTest, OneThatComesAgainWhileItWaitsIsStoredOnceAndAckedOnItsLastConnection) {
  Publish(bench_, 1, {.id = 5, .handle = 11});
  Publish(bench_, 1, {.id = 5, .dup = true, .handle = 21});
  EXPECT_EQ(bench_.Count(Became::kDuplicate), 1U);
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(21U));
  EXPECT_EQ(Stored(), 1U);
}

TEST_F(CommitsTest, OneThatComesAgainAfterItsCommitIsAckedOnceTheStoreHasAnswered) {
  Publish(bench_, 1, {.id = 5, .handle = 11});
  Publish(bench_, 2, {.id = 6, .handle = 12});
  bench_.Run();
  (void)bench_.Acked();
  Publish(bench_, 1, {.id = 5, .dup = true, .handle = 21});
  EXPECT_THAT(bench_.Acked(), IsEmpty());
  bench_.store.FailNextCommits(1, FailAt::kBefore);
  bench_.Run();
  Publish(bench_, 2, {.id = 6, .dup = true, .handle = 22});
  EXPECT_THAT(bench_.Acked(), IsEmpty()) << "the store may be gone";
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(21U)) << "the other came after the journal was asked";
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(22U));
  EXPECT_EQ(Stored(), 2U);
}

TEST_F(CommitsTest, HoweverManyComeAgainTheStoreIsAskedTwice) {
  constexpr std::uint16_t kMessages = 1'000;
  for (std::uint16_t id = 1; id <= kMessages; ++id) Publish(bench_, id, {.id = id, .handle = id});
  bench_.Run();
  (void)bench_.Acked();
  const std::size_t before = bench_.store.commits();
  for (std::uint16_t id = 1; id <= kMessages; ++id) {
    Publish(bench_, id, {.id = id, .dup = true, .handle = id});
  }
  bench_.Run();
  bench_.Run();
  EXPECT_EQ(bench_.Acked().size(), kMessages);
  EXPECT_EQ(bench_.store.commits() - before, 2U) << "for the first, and for all that came after it";
}

TEST_F(CommitsTest, WhatCameAgainByAnEarlierConnectionIsNotAcked) {
  Publish(bench_, 1, {.id = 5, .handle = 11});
  bench_.Run();
  (void)bench_.Acked();
  Publish(bench_, 1, {.id = 5, .dup = true, .handle = 21});
  bench_.commits.BeginConnection();
  Publish(bench_, 1, {.id = 5, .dup = true, .handle = 31});
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), IsEmpty()) << "the journal was asked before this one came";
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(31U));
}

TEST_F(CommitsTest, ThatItIsAgainIsTheBrokersWordAndItsContent) {
  Publish(bench_, 1, {.id = 5, .handle = 11});
  bench_.Run();
  Publish(bench_, 1, {.id = 5, .handle = 12});
  Publish(bench_, 2, {.id = 5, .dup = true, .handle = 13});
  Publish(bench_, 2, {.id = 6, .dup = true, .handle = 14});
  bench_.Run();
  EXPECT_EQ(Stored(), 4U) << "without DUP, with other content, under another id: new ones";
}

TEST_F(CommitsTest, TheNextProcessKnowsWhatWasCommitted) {
  Publish(bench_, 1, {.id = 5, .handle = 11});
  bench_.Write();
  // It is killed before it acks.
  Bench next(database_, 2);
  ASSERT_TRUE(next.TakeLease({{.process = {1}, .lease_counter = 0}}));
  Publish(next, 1, {.id = 5, .dup = true, .handle = 21});
  Publish(next, 2, {.id = 6, .handle = 22});
  next.Run();
  EXPECT_THAT(next.Acked(), ::testing::UnorderedElementsAre(21U, 22U));
  EXPECT_EQ(Stored(), 2U);
}

TEST_F(CommitsTest, FarMoreThanAWindowMayComeAgain) {
  // mosquitto's, which heeds none: all of this is committed, and it has read no PUBACK.
  static constexpr std::uint16_t kMessages = 4'000;
  const auto publish = [](Bench& bench, bool dup) {
    for (std::uint16_t id = 1; id <= kMessages; ++id) {
      Publish(bench, id, {.id = id, .dup = dup, .handle = id});
    }
    bench.Run();
    bench.Run();
    EXPECT_EQ(bench.Acked().size(), kMessages);
  };
  publish(bench_, false);
  publish(bench_, true);
  EXPECT_EQ(bench_.Count(Became::kDuplicate), kMessages);
  Bench next(database_, 2);
  ASSERT_TRUE(next.TakeLease({{.process = {1}, .lease_counter = 0}}));
  publish(next, true);
  EXPECT_EQ(next.Count(Became::kDuplicate), kMessages);
}

TEST_F(CommitsTest, WhatWasNotCommittedIsNewForTheNextProcess) {
  Publish(bench_, 1, {.id = 5, .handle = 11});
  Bench next(database_, 2);
  ASSERT_TRUE(next.TakeLease({{.process = {1}, .lease_counter = 0}}));
  Publish(next, 1, {.id = 5, .dup = true, .handle = 21});
  next.Run();
  EXPECT_THAT(next.Acked(), ElementsAre(21U));
  EXPECT_EQ(Stored(), 1U);
}

TEST_F(CommitsTest, ACommitWhoseAnswerWasLostIsStoredOnce) {
  Publish(bench_, 1, {.id = 5, .handle = 11});
  bench_.store.FailNextCommits(1, FailAt::kAfter);
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), IsEmpty());
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U));
  EXPECT_EQ(Stored(), 1U);
  EXPECT_EQ(bench_.Count(Became::kStored), 1U);
}

TEST_F(CommitsTest, OfALostSessionNothingIsKnown) {
  Publish(bench_, 1, {.id = 5, .handle = 11});
  bench_.Run();
  (void)bench_.Acked();
  bench_.Remember(bench_.commits.EndSession());
  Publish(bench_, 1, {.id = 5, .dup = true, .handle = 21});
  bench_.Run();
  EXPECT_EQ(Stored(), 2U);
  Bench next(database_, 2);
  ASSERT_TRUE(next.TakeLease({{.process = {1}, .lease_counter = 0}}));
  Publish(next, 1, {.id = 5, .dup = true, .handle = 31});
  next.Run();
  EXPECT_THAT(next.Acked(), ElementsAre(31U)) << "the one that came after is known";
}

TEST_F(CommitsTest, TheStoreRemembersALostSessionBeforeAnythingElseIsCommitted) {
  Publish(bench_, 1, {.id = 5, .handle = 11});
  bench_.Run();
  bench_.Remember(bench_.commits.EndSession());
  bench_.Run();
  Bench next(database_, 2);
  ASSERT_TRUE(next.TakeLease({{.process = {1}, .lease_counter = 0}}));
  Publish(next, 1, {.id = 5, .dup = true, .handle = 31});
  next.Run();
  EXPECT_EQ(Stored(), 2U) << "another message, which the broker may have sent before";
}

TEST_F(CommitsTest, OneWhoseLeaseIsOverWritesNothingAndAsksForAnotherConnection) {
  Publish(bench_, 1, {.id = 5, .handle = 11});
  Bench next(database_, 2);
  ASSERT_TRUE(next.TakeLease({{.process = {1}, .lease_counter = 0}}));
  bench_.Run();
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), IsEmpty());
  EXPECT_TRUE(bench_.commits.TakeFenced());
  EXPECT_FALSE(bench_.commits.TakeFenced());
  EXPECT_EQ(bench_.Count(Became::kRefused), 1U);
  EXPECT_EQ(bench_.ledger.Read().messages.in_flight, 0);
  EXPECT_EQ(Stored(), 0U);
  Publish(next, 1, {.id = 5, .dup = true, .handle = 21});
  next.Run();
  EXPECT_EQ(Stored(), 1U);
}

TEST_F(CommitsTest, WhatTheStoreRefusesIsRejectedAndAcked) {
  bench_.store.SetRules({.refuse = [](const storage::CommitRecord& record) {
    return record.seq == 1 ? std::optional(model::Rejection{
                                 .reason = model::RejectReason::kTextNotUtf8, .detail = "no"})
                           : std::nullopt;
  }});
  Publish(bench_, 1, {.id = 5, .handle = 11});
  Publish(bench_, 2, {.id = 6, .handle = 12});
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U, 12U));
  EXPECT_EQ(bench_.Count(Became::kRejected), 1U);
  EXPECT_EQ(bench_.Count(Became::kStored), 1U);
}

TEST_F(CommitsTest, StreamsThatEndSettleWhatWaits) {
  Publish(bench_, 1, {.id = 5, .handle = 11});
  bench_.streams.EndAll();
  EXPECT_EQ(bench_.streams.size(), 1U);
  bench_.Run();
  EXPECT_EQ(bench_.Count(Became::kStored), 1U);
  EXPECT_EQ(bench_.streams.size(), 0U);
}

}  // namespace
}  // namespace uplink::broker
