#include <gmock/gmock.h>

#include "tests/contract/store_contract.h"

/// What operators and servers say to each other about robots to forget.
namespace uplink::testing {
namespace {

using storage::ForgetAnswer;
using storage::PendingForget;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class ForgetRequestsContract : public StoreContract {
 protected:
  storage::ForgetRequests& Requests() { return store_->forget_requests(); }
  template <typename T>
  static T ValueOf(absl::StatusOr<T> value) {
    EXPECT_TRUE(value.ok()) << value.status();
    return value.ok() ? *std::move(value) : T();
  }
  std::uint64_t Ask(bool end_stream = false) {
    return ValueOf(Requests().Ask(robot_->ruri, end_stream));
  }
  std::vector<PendingForget> Pending() { return ValueOf(Requests().Pending()); }
  void Age(std::chrono::seconds time) { store_->AgeForgetRequests(time); }
};

TEST_P(ForgetRequestsContract, AreSeenByServersAndTheirAnswersByWhoeverAsked) {
  Fresh();
  EXPECT_THAT(Pending(), IsEmpty());
  const std::uint64_t number = Ask(true);
  EXPECT_EQ(ValueOf(Requests().AnswerTo(number)).answer, ForgetAnswer::kNone);
  auto pending = Pending();
  ASSERT_THAT(pending, SizeIs(1));
  EXPECT_EQ(pending[0].number, number);
  EXPECT_EQ(pending[0].ruri, robot_->ruri);
  EXPECT_TRUE(pending[0].end_stream);
  EXPECT_FALSE(pending[0].finished);
  const storage::Epoch epoch = Open().epoch;
  pending = Pending();
  ASSERT_TRUE(pending.at(0).hold.has_value());
  EXPECT_EQ(pending[0].hold->owner, storage::ProcessId{kProcess});
  EXPECT_EQ(pending[0].hold->epoch, epoch);

  ASSERT_TRUE(Requests().Answer(number, {ForgetAnswer::kLetGo, 42}).ok());
  ASSERT_TRUE(Requests().Answer(number, {ForgetAnswer::kHasStream, 0}).ok());
  const storage::AnsweredForget answer = ValueOf(Requests().AnswerTo(number));
  EXPECT_EQ(answer.answer, ForgetAnswer::kLetGo) << "the first answer stands";
  EXPECT_EQ(answer.epoch, 42U);
  EXPECT_THAT(Pending(), IsEmpty());

  store_->DeleteRobotRow(robot_->ruri);
  ASSERT_TRUE(Requests().Finish(number, true).ok());
  pending = Pending();
  ASSERT_THAT(pending, SizeIs(1)) << "the others learn of it";
  EXPECT_TRUE(pending[0].finished);
  EXPECT_TRUE(pending[0].removed);
  EXPECT_FALSE(pending[0].hold.has_value());
}

TEST_P(ForgetRequestsContract, OneThatWasGivenUpTakesNoAnswer) {
  Fresh();
  const std::uint64_t number = Ask();
  ASSERT_TRUE(Requests().Finish(number, false).ok());
  ASSERT_TRUE(Requests().Answer(number, {ForgetAnswer::kLetGo, 1}).ok());
  EXPECT_EQ(ValueOf(Requests().AnswerTo(number)).answer, ForgetAnswer::kNone);
  EXPECT_FALSE(Pending().at(0).removed);
}

TEST_P(ForgetRequestsContract, OneWithoutAnAnswerIsNotAskedForLong) {
  Fresh();
  Ask();
  Age(storage::kForgetRequestLives - std::chrono::seconds(10));
  EXPECT_THAT(Pending(), SizeIs(1));
  Age(std::chrono::seconds(10));
  EXPECT_THAT(Pending(), IsEmpty());
}

TEST_P(ForgetRequestsContract, OneThatIsFinishedIsToldForADay) {
  Fresh();
  const std::uint64_t number = Ask();
  Age(storage::kForgottenTold);
  ASSERT_TRUE(Requests().Finish(number, true).ok());
  Age(storage::kForgottenTold - std::chrono::seconds(10));
  EXPECT_THAT(Pending(), SizeIs(1)) << "from its end on";
  Age(std::chrono::seconds(10));
  EXPECT_THAT(Pending(), IsEmpty());
}

TEST_P(ForgetRequestsContract, OldOnesGoWithTheNext) {
  Fresh();
  const std::uint64_t old = Ask();
  ASSERT_TRUE(Requests().Answer(old, {ForgetAnswer::kLetGo, 42}).ok());
  Age(storage::kForgottenTold - std::chrono::seconds(10));
  Ask();
  EXPECT_EQ(ValueOf(Requests().AnswerTo(old)).epoch, 42U);
  Age(std::chrono::seconds(20));
  const std::uint64_t latest = Ask();
  EXPECT_EQ(ValueOf(Requests().AnswerTo(old)).epoch, 0U) << "it is gone";
  EXPECT_GT(latest, old) << "numbers never come again";
}

TEST_P(ForgetRequestsContract, TheLatestAreNamed) {
  Fresh();
  std::uint64_t last = 0;
  for (std::size_t i = 0; i < storage::kForgetRequestsMax + 1; ++i) last = Ask();
  const auto pending = Pending();
  ASSERT_THAT(pending, SizeIs(storage::kForgetRequestsMax));
  EXPECT_EQ(pending.front().number, last);
  ASSERT_TRUE(Requests().Answer(last, {ForgetAnswer::kLetGo, 1}).ok());
  EXPECT_THAT(Pending(), SizeIs(storage::kForgetRequestsMax)) << "its place is the next one's";
}

INSTANTIATE_TEST_SUITE_P(Stores, ForgetRequestsContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
