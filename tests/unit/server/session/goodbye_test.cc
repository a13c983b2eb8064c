// A robot that says that it is parked.
#include "server/session/goodbye.h"

#include <limits>

#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using std::chrono::hours;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr SystemTime kNow = FromUnixMs(1'000'000'000'000);
constexpr milliseconds kMax = hours(12);

TEST(JudgeGoodbye, TakesATimeAheadUpToTheMaximum) {
  EXPECT_EQ(JudgeGoodbye(UnixMs(kNow) + 1, kNow, kMax).until, kNow + milliseconds(1));
  EXPECT_EQ(JudgeGoodbye(UnixMs(kNow + kMax), kNow, kMax).until, kNow + kMax);
}

TEST(JudgeGoodbye, CutsALaterOne) {
  for (const std::int64_t back :
       {UnixMs(kNow + kMax) + 1, std::numeric_limits<std::int64_t>::max()}) {
    const ExpectedBack judged = JudgeGoodbye(back, kNow, kMax);
    EXPECT_EQ(judged.until, kNow + kMax);
    EXPECT_EQ(judged.dropped, std::nullopt);
  }
}

TEST(JudgeGoodbye, DropsOneThatIsNotAhead) {
  for (const std::int64_t back : {UnixMs(kNow), std::int64_t{1}, std::int64_t{-1},
                                  std::numeric_limits<std::int64_t>::min()}) {
    const ExpectedBack judged = JudgeGoodbye(back, kNow, kMax);
    EXPECT_EQ(judged.until, std::nullopt);
    ASSERT_TRUE(judged.dropped.has_value());
    EXPECT_EQ(judged.dropped->reason, model::RejectReason::kOutOfRange);
  }
  EXPECT_EQ(JudgeGoodbye(0, kNow, kMax).dropped->reason, model::RejectReason::kMissingField);
}

class GoodbyeTest : public SessionTest {
 protected:
  static v1::RelayRequest Goodbye(std::int64_t back) {
    v1::RelayRequest frame;
    frame.mutable_goodbye()->set_expected_back_unix_ms(back);
    return frame;
  }
  [[nodiscard]] std::int64_t In(milliseconds time) const { return UnixMs(clock_.System() + time); }
  BenchStream& Welcomed(std::uint8_t session) {
    BenchStream& stream = server().Connect(SessionOf(session));
    static_cast<void>(stream.TakeLines());
    return stream;
  }
  std::optional<SystemTime> parked() { return server().robot().state.parked_until(); }
};

TEST_F(GoodbyeTest, ParksTheRobotUntilItSpeaksOnAnotherStream) {
  BenchStream& stream = Welcomed(1);
  stream.Send(BatchFrame({{1, Motion()}}));
  stream.Send(Goodbye(In(hours(2))));
  EXPECT_EQ(parked(), clock_.System() + hours(2));
  stream.Send(BatchFrame({{2, Motion()}}));
  EXPECT_TRUE(parked().has_value()) << "it is its stream's end that counts";
  stream.HalfClose();
  server().Commit();
  EXPECT_EQ(stream.end(), "OK");
  EXPECT_TRUE(parked().has_value());

  BenchStream& later = Welcomed(2);
  EXPECT_TRUE(parked().has_value()) << "a stream alone is no sign of life";
  clock_.Advance(milliseconds(1));
  later.Send(BatchFrame({{1, Motion()}}));
  EXPECT_EQ(parked(), std::nullopt);
}

TEST_F(GoodbyeTest, CountsHoweverItsStreamEnds) {
  Welcomed(1).Send(Goodbye(In(hours(2))));
  BenchStream& newer = Welcomed(2);
  EXPECT_TRUE(parked().has_value()) << "superseded";
  clock_.Advance(milliseconds(1));
  newer.Send(BatchFrame({{1, Motion()}}));
  EXPECT_EQ(parked(), std::nullopt);
  newer.Send(Goodbye(In(hours(2))));
  newer.Break();
  EXPECT_TRUE(parked().has_value());
}

TEST_F(GoodbyeTest, ABadTimeGetsANoticeAndNothingElseIsLost) {
  BenchStream& stream = Welcomed(1);
  stream.Send(BatchFrame({{1, Fault()}}));
  stream.Send(Goodbye(0));
  stream.Send(Goodbye(0));
  clock_.Advance(std::chrono::seconds(1));
  stream.Send(Goodbye(-1));
  EXPECT_EQ(parked(), std::nullopt);
  EXPECT_EQ(server().probe().notices_total.value(), 2) << "one per second";
  EXPECT_THAT(stream.TakeLines(),
              ::testing::IsSupersetOf({"notice 0 missing_field goodbye.expected_back_unix_ms",
                                       "notice 0 out_of_range goodbye.expected_back_unix_ms"}));
  stream.HalfClose();
  server().Commit();
  EXPECT_EQ(stream.end(), "OK");
  EXPECT_THAT(Stored(1), ElementsAre(1));
}

TEST_F(GoodbyeTest, ABadOneLeavesTheGoodOneBefore) {
  BenchStream& stream = Welcomed(1);
  stream.Send(Goodbye(In(hours(2))));
  stream.Send(Goodbye(1));
  EXPECT_EQ(parked(), clock_.System() + hours(2));
}

TEST_F(GoodbyeTest, IsCutToTheMaximum) {
  Welcomed(1).Send(Goodbye(In(hours(1'000))));
  EXPECT_EQ(parked(), clock_.System() + robot::PresenceLimits().parked_max);
}

TEST_F(GoodbyeTest, ComesAfterHello) {
  BenchStream& stream = server().Open();
  stream.Send(Goodbye(In(hours(2))));
  EXPECT_EQ(stream.end(), "INVALID_ARGUMENT: frame 1: the first frame must be a hello");
}

TEST_F(GoodbyeTest, HasNoMoreThanAHello) {
  BenchStream& stream = Welcomed(1);
  std::string bytes = Goodbye(In(hours(2))).SerializeAsString();
  v1::RelayRequest padded;
  padded.mutable_hello()->set_agent_version(std::string(kHelloFrameBytesMax, 'x'));
  stream.SendBytes(padded.SerializeAsString() + bytes);
  EXPECT_THAT(stream.end(), ::testing::HasSubstr("a hello or goodbye of more than 16 KiB"));
  EXPECT_EQ(parked(), std::nullopt);
}

TEST_F(GoodbyeTest, TheLastContentOfAFrameCounts) {
  BenchStream& stream = Welcomed(1);
  stream.SendBytes(BatchFrame({{1, Fault()}}).SerializeAsString() +
                   Goodbye(In(hours(2))).SerializeAsString());
  EXPECT_TRUE(parked().has_value());
  stream.HalfClose();
  server().Commit();
  EXPECT_THAT(Stored(1), IsEmpty());
}

}  // namespace
}  // namespace uplink::session
