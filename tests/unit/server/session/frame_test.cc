// Frames that break the protocol: the words, and that nothing of such a frame is processed.
#include <limits>
#include <string>

#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::uint64_t kJump = kSeqJumpMax;

class FrameTest : public SessionTest {
 protected:
  BenchStream& Welcomed() {
    BenchStream& stream = server().Connect(SessionOf(1));
    static_cast<void>(stream.TakeLines());
    return stream;
  }
};

TEST_F(FrameTest, MustBeProtobuf) {
  BenchStream& stream = server().Open();
  stream.SendBytes("\xFF\xFF not a frame");
  EXPECT_EQ(stream.end(),
            "INVALID_ARGUMENT: frame 1: not a RelayRequest (bad protobuf, or a text that is not "
            "UTF-8)");
  EXPECT_EQ(server().probe().protocol_errors_total.value(), 1);
}

TEST_F(FrameTest, TextsMustBeUtf8) {
  v1::RelayRequest frame = HelloFrame(SessionOf(1));
  frame.mutable_hello()->set_agent_version("v\x01X");
  std::string bytes = frame.SerializeAsString();
  bytes[bytes.find('\x01', bytes.find('v'))] = '\xFF';
  BenchStream& stream = server().Open();
  stream.SendBytes(bytes);
  EXPECT_EQ(stream.end(),
            "INVALID_ARGUMENT: frame 1: not a RelayRequest (bad protobuf, or a text that is not "
            "UTF-8)");
}

TEST_F(FrameTest, MustHoldSomething) {
  BenchStream& stream = server().Open();
  stream.SendBytes("");
  EXPECT_EQ(stream.end(), "INVALID_ARGUMENT: frame 1: it holds neither hello, batch nor goodbye");
}

TEST_F(FrameTest, HelloComesOnce) {
  BenchStream& stream = Welcomed();
  stream.Send(HelloFrame(SessionOf(1)));
  EXPECT_EQ(stream.end(), "INVALID_ARGUMENT: frame 2: hello: only the first frame may be one");
}

TEST_F(FrameTest, HelloComesFirst) {
  BenchStream& stream = server().Open();
  stream.Send(BatchFrame({{1, Fault()}}));
  EXPECT_EQ(stream.end(), "INVALID_ARGUMENT: frame 1: the first frame must be a hello");
  EXPECT_EQ(server().counts().received, 0U);
}

TEST_F(FrameTest, HalfCloseBeforeHelloIsAnError) {
  BenchStream& stream = server().Open();
  stream.HalfClose();
  EXPECT_EQ(stream.end(), "INVALID_ARGUMENT: frame 1: the stream was half-closed before a hello");
}

TEST_F(FrameTest, TooLargeIsToldWithItsSize) {
  BenchStream& stream = Welcomed();
  stream.SendTooLarge(1048577);
  EXPECT_EQ(stream.end(),
            "RESOURCE_EXHAUSTED: frame 2: 1048577 bytes, the limit is 1048576 "
            "(limits.frame_bytes_max)");
  EXPECT_EQ(server().probe().protocol_errors_total.value(), 1);
}

TEST_F(FrameTest, TooLargeAfterDrainIsNotReadEither) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}}));
  stream.Drain(milliseconds(1000));
  stream.SendTooLarge(1048577);
  EXPECT_EQ(stream.end(), "");
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 1 judged 1");
  EXPECT_EQ(stream.end(), "UNAVAILABLE: the server drains");
}

TEST_F(FrameTest, BatchHoldsAtMostItsLimit) {
  limits_.session.batch_uplinks_max = 2;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 2, Fault())));
  EXPECT_EQ(stream.end(), "");
  stream.Send(BatchFrame(Messages(3, 5, Fault())));
  EXPECT_EQ(stream.end(),
            "INVALID_ARGUMENT: frame 3: batch.uplinks: 3 messages, the limit is 2 "
            "(limits.batch_uplinks_max)");
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1, 2)) << "what was taken before still commits";
}

TEST_F(FrameTest, AnEmptyBatchIsNoError) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({}));
  EXPECT_EQ(stream.end(), "");
  EXPECT_TRUE(stream.reading());
  EXPECT_THAT(stream.TakeLines(), IsEmpty());
}

TEST_F(FrameTest, NumbersBeginAtOne) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{0, Fault()}}));
  EXPECT_EQ(stream.end(), "INVALID_ARGUMENT: frame 2: batch.uplinks[0].seq: it must be at least 1");
}

TEST_F(FrameTest, TheHighestNumberPasses) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{model::kSeqMax, Motion()}}));
  EXPECT_EQ(stream.end(), "");
  EXPECT_EQ(server().counts().missing, robot::kMissingPerJumpMax) << "a jump adds no more";
}

TEST_F(FrameTest, OneMoreThanTheHighestNumberIsAnError) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{model::kSeqMax + 1, Motion()}}));
  EXPECT_EQ(stream.end(),
            "INVALID_ARGUMENT: frame 2: batch.uplinks[0].seq: 9223372036854775808 is over 2^63-1");
}

TEST_F(FrameTest, NumbersIncreaseWithinAFrame) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}, {2, Fault()}, {2, Fault()}}));
  EXPECT_EQ(stream.end(),
            "INVALID_ARGUMENT: frame 2: batch.uplinks[2].seq: 2 does not increase over 2");
  server().Commit();
  EXPECT_EQ(server().counts().received, 0U) << "nothing of a bad frame is taken";
  EXPECT_THAT(Stored(1), IsEmpty());
}

TEST_F(FrameTest, NumbersIncreaseOverFrames) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{7, Fault()}}));
  stream.Send(BatchFrame({{6, Fault()}}));
  EXPECT_EQ(stream.end(),
            "INVALID_ARGUMENT: frame 3: batch.uplinks[0].seq: 6 does not increase over 7");
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(7));
}

TEST_F(FrameTest, AJumpOfTwoToThe32Passes) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Motion()}, {1 + kJump, Motion()}}));
  EXPECT_EQ(stream.end(), "");
  stream.Send(BatchFrame({{1 + 2 * kJump, Motion()}}));
  EXPECT_EQ(stream.end(), "");
}

TEST_F(FrameTest, ALargerJumpIsAnError) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Motion()}}));
  stream.Send(BatchFrame({{2 + kJump, Motion()}}));
  EXPECT_EQ(stream.end(),
            "INVALID_ARGUMENT: frame 3: batch.uplinks[0].seq: 4294967298 jumps over more than 2^32 "
            "numbers from 1");
}

TEST_F(FrameTest, AJumpWithinTheFirstFrameIsAnErrorToo) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Motion()}, {2 + kJump, Motion()}}));
  EXPECT_EQ(stream.end(),
            "INVALID_ARGUMENT: frame 2: batch.uplinks[1].seq: 4294967298 jumps over more than 2^32 "
            "numbers from 1");
  EXPECT_EQ(server().counts().received, 0U);
}

TEST_F(FrameTest, AStreamsFirstMessageMayJumpAnyWay) {
  BenchStream& first = Welcomed();
  first.Send(BatchFrame({{1, Motion()}}));
  first.Break();
  BenchStream& second = Welcomed();
  second.Send(BatchFrame({{5 * kJump, Motion()}}));
  EXPECT_EQ(second.end(), "");
}

TEST_F(FrameTest, SentTimeTellsTheClocksSkew) {
  BenchStream& stream = Welcomed();
  v1::RelayRequest frame = BatchFrame({});
  frame.mutable_batch()->set_sent_unix_ms(UnixMs(clock_.System()) + 1500);
  stream.Send(frame);
  const auto snapshot = server().robot().state.Snapshot(robot::RobotState::Parts::kNone);
  EXPECT_EQ(snapshot.clock_skew_ms, 1500);
  EXPECT_FALSE(snapshot.backlog) << "an agent that does not say it";
}

TEST_F(FrameTest, AnAgentSaysHowFarBehindItIsUntilItsStreamEnds) {
  BenchStream& stream = Welcomed();
  v1::RelayRequest frame = BatchFrame({{1, Motion()}});
  frame.mutable_batch()->set_sent_unix_ms(90'000);
  frame.mutable_batch()->set_backlog_uplinks(12);
  frame.mutable_batch()->set_oldest_unsent_unix_ms(80'000);
  stream.Send(frame);
  const auto backlog = [this] {
    return server().robot().state.Snapshot(robot::RobotState::Parts::kNone).backlog;
  };
  EXPECT_EQ(backlog(), (robot::Backlog{.uplinks = 12,
                                       .oldest_unsent = clock_.System() - std::chrono::seconds(10),
                                       .said_at = clock_.System()}));
  stream.Break();
  EXPECT_TRUE(backlog()) << "what it said last";
  Welcomed();
  EXPECT_FALSE(backlog()) << "another stream, which has said nothing";
}

TEST_F(FrameTest, AnAbsurdHeadOfABatchIsNoError) {
  BenchStream& stream = Welcomed();
  model::Seq seq = 0;
  for (const std::int64_t odd : {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1},
                                 std::numeric_limits<std::int64_t>::max()}) {
    v1::RelayRequest frame = BatchFrame({{++seq, Motion()}});
    frame.mutable_batch()->set_sent_unix_ms(odd);
    frame.mutable_batch()->set_backlog_uplinks(static_cast<std::uint64_t>(odd));
    frame.mutable_batch()->set_oldest_unsent_unix_ms(odd);
    stream.Send(frame);
  }
  EXPECT_EQ(stream.end(), "");
  EXPECT_EQ(server().counts().received, 3U);
  const auto snapshot = server().robot().state.Snapshot(robot::RobotState::Parts::kNone);
  EXPECT_FALSE(snapshot.clock_skew_ms);
  EXPECT_FALSE(snapshot.backlog);
}

}  // namespace
}  // namespace uplink::session
