#include "tools/uplink-fleet/robot/agent_model.h"

#include <algorithm>
#include <array>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::synthetic {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

class AgentModelTest : public ::testing::Test {
 protected:
  AgentModelTest() : model_(model::SessionId(std::array<std::uint8_t, 16>{7})) {}

  void OfferDurable(std::uint64_t tag) {
    ASSERT_TRUE(model_.Offer({Keeping::kDurable, Content::kRoverNexus, "durable", tag}));
  }
  void OfferLive() { ASSERT_TRUE(model_.Offer({Keeping::kLive, Content::kRoverNexus, "live", 0})); }

  absl::Status Receive(const v1::RelayResponse& frame) {
    return model_.OnFrame(frame, clock_.Steady());
  }

  static v1::RelayResponse WelcomeAt(model::Seq committed) {
    v1::RelayResponse frame;
    v1::Welcome& welcome = *frame.mutable_welcome();
    welcome.set_committed_seq(committed);
    welcome.mutable_limits()->set_batch_uplinks_max(4);
    welcome.mutable_limits()->set_frame_bytes_max(1000);
    return frame;
  }
  static v1::RelayResponse AckOf(model::Seq through, model::Seq judged) {
    v1::RelayResponse frame;
    frame.mutable_ack()->set_through_seq(through);
    frame.mutable_ack()->set_judged_seq(judged);
    return frame;
  }
  static v1::RelayResponse RejectOf(model::Seq seq, v1::RejectReason reason) {
    v1::RelayResponse frame;
    frame.mutable_reject()->set_seq(seq);
    frame.mutable_reject()->set_reason(reason);
    frame.mutable_reject()->set_field("faultId");
    return frame;
  }

  /// A stream that the server welcomed.
  v1::Hello Connect(model::Seq committed = 0) {
    v1::Hello hello = model_.BeginStream("test");
    EXPECT_TRUE(Receive(WelcomeAt(committed)).ok());
    return hello;
  }

  /// Everything that may be sent now, by number.
  std::vector<model::Seq> SendAll() {
    std::vector<model::Seq> numbers;
    while (const auto batch = model_.NextBatch(clock_.Steady(), kAll)) {
      for (const v1::Uplink& uplink : batch->uplinks()) {
        numbers.push_back(uplink.seq());
      }
    }
    return numbers;
  }

  std::vector<std::uint64_t> SettledTags() {
    std::vector<std::uint64_t> tags;
    for (const Settled& settled : model_.TakeSettled()) {
      tags.push_back(settled.tag);
    }
    return tags;
  }

  testing::ManualClock clock_;
  AgentModel model_;
};

TEST_F(AgentModelTest, WhatMustBeSentAgainIsUnsent) {
  Connect();
  for (std::uint64_t tag = 1; tag <= 6; ++tag) OfferDurable(tag);
  EXPECT_EQ(model_.unsent().messages, 6U);
  static_cast<void>(model_.NextBatch(clock_.Steady(), kAll));
  EXPECT_EQ(model_.unsent().messages, 2U);
  SendAll();
  EXPECT_EQ(model_.unsent().messages, 0U);
  EXPECT_FALSE(model_.unsent().since);
  model_.EndStream();
  Connect(1);
  EXPECT_EQ(model_.unsent().messages, 5U);
}

TEST_F(AgentModelTest, SendsNothingBeforeTheWelcome) {
  OfferDurable(1);
  EXPECT_THAT(SendAll(), IsEmpty());
  const v1::Hello hello = model_.BeginStream("test");
  EXPECT_EQ(hello.session_id().size(), 16U);
  EXPECT_EQ(hello.settled_seq(), 0U);
  EXPECT_THAT(SendAll(), IsEmpty());
  ASSERT_TRUE(Receive(WelcomeAt(0)).ok());
  EXPECT_THAT(SendAll(), ElementsAre(1));
}

TEST_F(AgentModelTest, NumbersFromOneWithoutSkipping) {
  Connect();
  OfferDurable(1);
  OfferLive();
  OfferDurable(2);
  EXPECT_THAT(SendAll(), ElementsAre(1, 2, 3));
  OfferLive();
  EXPECT_THAT(SendAll(), ElementsAre(4));
}

TEST_F(AgentModelTest, KeepsWithinTheServersBatchLimit) {
  Connect();
  for (std::uint64_t i = 0; i < 9; ++i) OfferDurable(i);
  std::vector<int> sizes;
  while (const auto batch = model_.NextBatch(clock_.Steady(), kAll)) {
    sizes.push_back(batch->uplinks_size());
  }
  EXPECT_THAT(sizes, ElementsAre(4, 4, 1));
}

TEST_F(AgentModelTest, KeepsWithinTheServersFrameLimit) {
  Connect();
  const std::string large(500, 'x');
  ASSERT_TRUE(model_.Offer({Keeping::kDurable, Content::kRoverNexus, large, 1}));
  ASSERT_TRUE(model_.Offer({Keeping::kDurable, Content::kRoverNexus, large, 2}));
  const auto batch = model_.NextBatch(clock_.Steady(), kAll);
  ASSERT_TRUE(batch.has_value());
  EXPECT_EQ(batch->uplinks_size(), 1);
  EXPECT_LE(batch->ByteSizeLong(), 1000U);
}

TEST_F(AgentModelTest, AJudgedLiveMessageIsForgottenADurableOneIsNot) {
  Connect();
  OfferDurable(1);
  OfferLive();
  SendAll();
  ASSERT_TRUE(Receive(AckOf(0, 2)).ok());
  EXPECT_FALSE(model_.durable_settled());
  EXPECT_THAT(SettledTags(), IsEmpty());
  model_.EndStream();
  Connect();
  EXPECT_THAT(SendAll(), ElementsAre(1));
}

TEST_F(AgentModelTest, OnlyAnAckLetsADurableMessageGo) {
  Connect();
  OfferDurable(1);
  OfferDurable(2);
  SendAll();
  model_.EndStream();
  // Welcome says that both are stored: not sent again, yet still kept.
  Connect(2);
  EXPECT_THAT(SendAll(), IsEmpty());
  EXPECT_FALSE(model_.all_settled());
  ASSERT_TRUE(Receive(AckOf(2, 2)).ok());
  EXPECT_THAT(SettledTags(), ElementsAre(1, 2));
  EXPECT_TRUE(model_.all_settled());
}

TEST_F(AgentModelTest, AfterABreakKeptMessagesComeInOrderBeforeAnythingNew) {
  Connect();
  for (std::uint64_t i = 1; i <= 3; ++i) OfferDurable(i);
  SendAll();
  ASSERT_TRUE(Receive(AckOf(1, 3)).ok());
  model_.EndStream();
  OfferDurable(4);
  const v1::Hello hello = Connect(1);
  EXPECT_EQ(hello.settled_seq(), 1U);
  EXPECT_EQ(hello.judged_seq(), 3U);
  EXPECT_THAT(SendAll(), ElementsAre(2, 3, 4));
  EXPECT_EQ(model_.resent(), 2U);
}

TEST_F(AgentModelTest, ABreakWhileSendingAgainBeginsAtTheWelcomeOnceMore) {
  Connect();
  for (std::uint64_t i = 1; i <= 6; ++i) OfferDurable(i);
  SendAll();
  model_.EndStream();
  Connect();
  ASSERT_TRUE(model_.NextBatch(clock_.Steady(), 2).has_value());
  EXPECT_TRUE(model_.resending());
  model_.EndStream();
  Connect();
  EXPECT_THAT(SendAll(), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST_F(AgentModelTest, JudgedSeqOfHelloIsTheHighestOfAckRejectAndWelcome) {
  Connect();
  for (std::uint64_t i = 1; i <= 5; ++i) OfferDurable(i);
  SendAll();
  ASSERT_TRUE(Receive(AckOf(1, 2)).ok());
  ASSERT_TRUE(Receive(RejectOf(3, v1::REJECT_REASON_MISSING_FIELD)).ok());
  model_.EndStream();
  EXPECT_EQ(Connect(4).judged_seq(), 3U);
  model_.EndStream();
  EXPECT_EQ(Connect(4).judged_seq(), 4U);
}

TEST_F(AgentModelTest, ARejectedMessageIsKeptUntilTheAck) {
  Connect();
  OfferDurable(1);
  SendAll();
  ASSERT_TRUE(Receive(RejectOf(1, v1::REJECT_REASON_MISSING_FIELD)).ok());
  EXPECT_FALSE(model_.durable_settled());
  ASSERT_TRUE(Receive(AckOf(1, 1)).ok());
  const std::vector<Settled> settled = model_.TakeSettled();
  ASSERT_EQ(settled.size(), 1U);
  ASSERT_TRUE(settled[0].rejection.has_value());
  EXPECT_EQ(settled[0].rejection->reason, model::RejectReason::kMissingField);
  EXPECT_EQ(settled[0].rejection->field, "faultId");
}

TEST_F(AgentModelTest, ARejectToldAgainAfterTheWelcomeIsNoError) {
  Connect();
  OfferDurable(1);
  SendAll();
  ASSERT_TRUE(Receive(RejectOf(1, v1::REJECT_REASON_MALFORMED)).ok());
  model_.EndStream();
  Connect(1);
  ASSERT_TRUE(Receive(RejectOf(1, v1::REJECT_REASON_MALFORMED)).ok());
  ASSERT_TRUE(Receive(AckOf(1, 1)).ok());
  EXPECT_THAT(SettledTags(), ElementsAre(1));
}

TEST_F(AgentModelTest, ARateLimitEndsTheNumberAndTheContentComesLaterUnderANewOne) {
  Connect();
  OfferDurable(1);
  SendAll();
  v1::RelayResponse limited = RejectOf(1, v1::REJECT_REASON_RATE_LIMITED);
  limited.mutable_reject()->set_retry_after_ms(500);
  ASSERT_TRUE(Receive(limited).ok());
  EXPECT_FALSE(model_.durable_settled());
  model_.EndStream();
  Connect();
  EXPECT_THAT(SendAll(), IsEmpty());
  clock_.Advance(milliseconds(499));
  EXPECT_THAT(SendAll(), IsEmpty());
  clock_.Advance(milliseconds(1));
  EXPECT_THAT(SendAll(), ElementsAre(2));
}

TEST_F(AgentModelTest, WhatWasLimitedGivesWayToALaterOneOfTheSameThatWasSent) {
  Connect();
  for (const std::uint64_t tag : {1U, 2U}) {
    Outgoing message{.keeping = Keeping::kDurable, .tag = tag, .latest_of = "object/a"};
    EXPECT_TRUE(model_.Offer(std::move(message)));
    SendAll();
  }
  v1::RelayResponse limited = RejectOf(1, v1::REJECT_REASON_RATE_LIMITED);
  ASSERT_TRUE(Receive(limited).ok());
  EXPECT_THAT(model_.TakeReplaced(), ElementsAre(1));
  EXPECT_THAT(SendAll(), IsEmpty());
  ASSERT_TRUE(Receive(RejectOf(2, v1::REJECT_REASON_RATE_LIMITED)).ok());
  EXPECT_THAT(model_.TakeReplaced(), IsEmpty());
  EXPECT_THAT(SendAll(), ElementsAre(3)) << "the latest comes again";
  EXPECT_FALSE(model_.durable_settled());
}

TEST_F(AgentModelTest, ADrainStopsSendingUntilTheNextStream) {
  Connect();
  v1::RelayResponse drain;
  drain.mutable_drain()->set_grace_ms(1000);
  ASSERT_TRUE(Receive(drain).ok());
  OfferDurable(1);
  EXPECT_THAT(SendAll(), IsEmpty());
  EXPECT_FALSE(model_.may_send());
  model_.EndStream();
  Connect();
  EXPECT_THAT(SendAll(), ElementsAre(1));
}

TEST_F(AgentModelTest, PastTheBoundTheOldestUnnumberedLiveMessageGivesWay) {
  OfferDurable(1);
  for (std::size_t i = 0; i < kLiveWaitingMax; ++i) OfferLive();
  EXPECT_THAT(model_.TakeGaveWay(), IsEmpty());
  OfferLive();
  EXPECT_EQ(model_.TakeGaveWay().size(), 1U);
  Connect();
  // Numbers were not given to what was dropped, so none is missing; the durable one stays first.
  const std::vector<model::Seq> numbers = SendAll();
  EXPECT_EQ(numbers.size(), kLiveWaitingMax + 1);
  EXPECT_EQ(numbers.back(), kLiveWaitingMax + 1);
}

TEST_F(AgentModelTest, DurableMessagesAreRefusedPastTheBound) {
  for (std::size_t i = 0; i < kDurableWaitingMax; ++i) OfferDurable(i);
  EXPECT_FALSE(model_.Offer({Keeping::kDurable, Content::kRoverNexus, "one more", 0}));
}

TEST_F(AgentModelTest, NumbersNothingNewWhileTooMuchIsUnsettled) {
  Connect();
  for (std::size_t i = 0; i < kKeptMax + 1; ++i) OfferDurable(i);
  EXPECT_EQ(SendAll().size(), kKeptMax);
  ASSERT_TRUE(Receive(AckOf(1, kKeptMax)).ok());
  EXPECT_THAT(SendAll(), ElementsAre(kKeptMax + 1));
}

TEST_F(AgentModelTest, FramesOfAnEndedStreamAreIgnored) {
  Connect();
  OfferDurable(1);
  SendAll();
  model_.EndStream();
  ASSERT_TRUE(Receive(AckOf(1, 1)).ok());
  EXPECT_FALSE(model_.all_settled());
}

class BrokenRule : public AgentModelTest {
 protected:
  void SetUp() override {
    Connect();
    for (std::uint64_t i = 1; i <= 3; ++i) OfferDurable(i);
    SendAll();
  }
};

TEST_F(BrokenRule, SecondWelcome) {
  EXPECT_THAT(std::string(Receive(WelcomeAt(0)).message()), HasSubstr("Welcome"));
}

TEST_F(BrokenRule, AckBeforeTheWelcome) {
  model_.EndStream();
  static_cast<void>(model_.BeginStream("test"));
  EXPECT_FALSE(Receive(AckOf(1, 1)).ok());
}

TEST_F(BrokenRule, AckThatShrinksOnOneStream) {
  ASSERT_TRUE(Receive(AckOf(2, 2)).ok());
  EXPECT_THAT(std::string(Receive(AckOf(1, 2)).message()), HasSubstr("(1, 2) came after (2, 2)"));
  EXPECT_FALSE(Receive(AckOf(2, 1)).ok());
}

TEST_F(BrokenRule, AckOfNumbersThatWereNeverSent) {
  EXPECT_TRUE(Receive(AckOf(3, 3)).ok());
  EXPECT_FALSE(Receive(AckOf(3, 4)).ok());
  EXPECT_FALSE(Receive(AckOf(4, 4)).ok());
}

TEST_F(BrokenRule, RejectAfterTheAckThatCoversIt) {
  ASSERT_TRUE(Receive(AckOf(2, 2)).ok());
  EXPECT_FALSE(Receive(RejectOf(2, v1::REJECT_REASON_MALFORMED)).ok());
  EXPECT_TRUE(Receive(RejectOf(3, v1::REJECT_REASON_MALFORMED)).ok());
  EXPECT_FALSE(Receive(RejectOf(4, v1::REJECT_REASON_MALFORMED)).ok());
}

TEST_F(BrokenRule, WelcomeBelowWhatIsSettled) {
  ASSERT_TRUE(Receive(AckOf(2, 2)).ok());
  model_.EndStream();
  static_cast<void>(model_.BeginStream("test"));
  EXPECT_FALSE(Receive(WelcomeAt(1)).ok());
}

TEST_F(BrokenRule, WelcomeAboveWhatWasSent) {
  model_.EndStream();
  static_cast<void>(model_.BeginStream("test"));
  EXPECT_FALSE(Receive(WelcomeAt(4)).ok());
}

TEST_F(BrokenRule, EmptyFrame) { EXPECT_FALSE(Receive(v1::RelayResponse()).ok()); }

}  // namespace
}  // namespace uplink::synthetic
