// What a stream sends, in which order, and when an Ack is due and released.
#include "server/session/outgoing.h"

#include <string>
#include <vector>

#include <fmt/format.h>

#include "server/session/frames.h"
#include "tests/unit/server/session/stream_part_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const model::Rejection kBad{model::RejectReason::kMissingField, "faultId", ""};

class RecordingSink final : public FrameSink {
 public:
  void Write(const v1::RelayResponse& frame) override { lines.push_back(ToLine(frame)); }
  void WriteEncoded(std::span<const EncodedFrame> frames) override {
    lines.push_back(fmt::format("{} encoded", frames.size()));
  }
  void Finish(const absl::Status& /*status*/) override {}
  void Cancel() override {}
  void AskPeer() override {}

  std::vector<std::string> lines;
};

class OutgoingTest : public StreamPartTest {
 protected:
  OutgoingTest() {
    EXPECT_TRUE(Attach(robot_, Terms(SessionOf(1))).ok());
    EXPECT_TRUE(robot_.Open(clock_.Steady()).ok());
  }
  robot::RobotSessions& sessions() { return robot_.robot().sessions; }
  void Settle(model::Seq seq, const storage::Outcome& outcome = {}) {
    const robot::Settled settled{.session = SessionOf(1), .seq = seq, .outcome = outcome};
    sessions().OnSettled({&settled, 1}, ledger_);
  }
  void Written() {
    outgoing_.OnWritten();
    outgoing_.Flush();
  }

  RecordingSink sink_;
  Outgoing outgoing_{{.context = context_, .robot = robot_, .sink = sink_, .timers = timers_}};
};

TEST_F(OutgoingTest, OneFrameAtATimeIsWrittenInOrder) {
  outgoing_.Push(RejectFrame(1, kBad));
  outgoing_.Push(RejectFrame(2, kBad));
  outgoing_.Flush();
  outgoing_.Flush();
  EXPECT_THAT(sink_.lines, ElementsAre("reject 1 missing_field faultId"));
  EXPECT_EQ(outgoing_.size(), 1U);
  Written();
  EXPECT_EQ(outgoing_.size(), 0U);
  EXPECT_FALSE(outgoing_.idle()) << "a write is under way";
  Written();
  EXPECT_TRUE(outgoing_.idle());
}

TEST_F(OutgoingTest, AnAckWaitsForTheFramesBeforeIt) {
  sessions().AddSettled(SessionOf(1), 3);
  outgoing_.MakeAckDue();
  outgoing_.Push(RejectFrame(2, kBad));
  outgoing_.Flush();
  EXPECT_THAT(sink_.lines, ElementsAre("reject 2 missing_field faultId"));
  Written();
  EXPECT_EQ(sink_.lines.back(), "ack 3 judged 3");
}

TEST_F(OutgoingTest, TheStoresRejectsGoBeforeTheAckThatCoversThem) {
  EXPECT_EQ(sessions().AddWaiting(SessionOf(1), 1), 1);
  outgoing_.MakeAckDue();
  Settle(1, {storage::OutcomeKind::kRefused, kBad});
  outgoing_.Flush();
  Written();
  EXPECT_THAT(sink_.lines, ElementsAre("reject 1 missing_field faultId", "ack 1 judged 1"));
}

TEST_F(OutgoingTest, ACommitThatMovesTheAckMakesItDue) {
  EXPECT_EQ(sessions().AddWaiting(SessionOf(1), 1), 1);
  EXPECT_EQ(sessions().AddWaiting(SessionOf(1), 2), 1);
  Settle(2);
  outgoing_.AddProgress();
  outgoing_.Flush();
  EXPECT_THAT(sink_.lines, IsEmpty()) << "1 still waits";
  Settle(1);
  outgoing_.AddProgress();
  outgoing_.Flush();
  EXPECT_THAT(sink_.lines, ElementsAre("ack 2 judged 2"));
  EXPECT_EQ(probe_.acks_total.value(), 1);
}

TEST_F(OutgoingTest, AnAckIsDueAfterSoManyMessages) {
  outgoing_.AddProcessed({.messages = kAckMessages - 1});
  EXPECT_TRUE(outgoing_.idle());
  outgoing_.AddProcessed({.messages = 1});
  EXPECT_FALSE(outgoing_.idle());
}

TEST_F(OutgoingTest, TheFirstMessageStartsTheTimeToAnAckAndTheAckEndsIt) {
  outgoing_.AddProcessed({.messages = 1});
  const SteadyTime at = clock_.Steady() + limits_.session.ack_interval;
  EXPECT_EQ(timers_.at(Timer::kAck), at);
  clock_.Advance(milliseconds(1));
  outgoing_.AddProcessed({.messages = 1});
  EXPECT_EQ(timers_.at(Timer::kAck), at);
  outgoing_.MakeAckDue();
  outgoing_.Flush();
  EXPECT_FALSE(timers_.is_set(Timer::kAck));
}

TEST_F(OutgoingTest, ASettledMessageThatCameAgainIsOwedAnAck) {
  outgoing_.AddProcessed({.messages = 1, .ack_owed = true});
  EXPECT_FALSE(outgoing_.idle());
}

}  // namespace
}  // namespace uplink::session
