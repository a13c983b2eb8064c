#include "tests/support/fake_store.h"

#include <chrono>
#include <memory>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/records.h"

namespace uplink::testing {
namespace {

using storage::OutcomeKind;
using ::testing::ElementsAre;

class FakeStoreFaults : public ::testing::Test {
 protected:
  FakeStoreFaults() { Open(store_); }

  void Open(FakeStore& store) {
    const storage::OpenRequest request{robot_, Other(), 0, FromUnixMs(1), {}};
    const auto opened = store.OpenStreams({&request, 1});
    ASSERT_TRUE(opened.ok()) << opened.status();
    hold_ = opened->front().held_since;
  }
  /// A session that no test looks at.
  static model::SessionId Other() { return model::SessionId({9}); }

  storage::Batch Numbers(model::Seq first, model::Seq last) const {
    storage::Batch batch;
    for (model::Seq seq = first; seq <= last; ++seq) {
      model::Message message;
      message.message = "m";
      batch.records.push_back(
          {robot_, session_, seq, hold_, FromUnixMs(1), test::RecordOf(message), "", 0});
    }
    return batch;
  }

  const storage::RobotRef robot_ =
      std::make_shared<const model::RobotId>(model::RobotId{"rcan://r", "f"});
  const model::SessionId session_{};
  /// Of what was opened last.
  storage::Epoch hold_ = 0;
  FakeDatabase database_;
  FakeStore store_{database_, {1}};
};

TEST_F(FakeStoreFaults, FailsBeforeThenAfterThenNoMore) {
  store_.FailNext(1, FailAt::kAfter);
  store_.FailNext(2, FailAt::kBefore, absl::ResourceExhaustedError("full"));
  EXPECT_FALSE(store_.Commit(Numbers(1, 1)).ok());
  EXPECT_EQ(store_.Commit(Numbers(1, 1)).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(database_.ApplicationCount(), 0);
  EXPECT_FALSE(store_.Commit(Numbers(1, 1)).ok());
  EXPECT_EQ(database_.ApplicationCount(), 1);
  EXPECT_TRUE(store_.Commit(Numbers(1, 1)).ok());
  EXPECT_EQ(store_.commits(), 4);
}

TEST_F(FakeStoreFaults, KeepsOrdersForOneOperationFromTheOther) {
  store_.FailNextOpens(1, FailAt::kBefore);
  EXPECT_TRUE(store_.Commit(Numbers(1, 1)).ok());
  const storage::OpenRequest request{robot_, session_, 0, FromUnixMs(1), {}};
  EXPECT_FALSE(store_.OpenStreams({&request, 1}).ok());
  store_.FailNextCommits(5, FailAt::kBefore);
  EXPECT_TRUE(store_.OpenStreams({&request, 1}).ok());
  EXPECT_FALSE(store_.Commit(Numbers(2, 2)).ok());
  store_.Heal();
  EXPECT_TRUE(store_.Commit(Numbers(2, 2)).ok());
}

TEST_F(FakeStoreFaults, LogsWhatWasWritten) {
  FakeRules rules;
  rules.refuse = [](const storage::CommitRecord& record) -> std::optional<model::Rejection> {
    if (record.seq != 2) return std::nullopt;
    return model::Rejection{model::RejectReason::kStoreRefused, "", "two"};
  };
  store_.SetRules(rules);
  ASSERT_TRUE(store_.Commit(Numbers(1, 3)).ok());
  const SessionLog log = database_.Log(robot_->ruri, session_);
  EXPECT_THAT(log.stored, ElementsAre(1, 3));
  EXPECT_EQ(log.quarantined.at(2).detail, "two");
  EXPECT_EQ(database_.QuarantineReason(robot_->ruri, session_, 2)->detail, "two");
  EXPECT_EQ(database_.TimesWritten(robot_->ruri, session_, 3), 1);
  EXPECT_EQ(database_.TimesWritten(robot_->ruri, session_, 4), 0);
  EXPECT_EQ(database_.Cursor(robot_->ruri, session_), 3);
  EXPECT_EQ(database_.Cursor("rcan://none", session_), std::nullopt);
  const auto from = database_.ApplicationsFrom(1);
  ASSERT_EQ(from.size(), 2);
  EXPECT_TRUE(from[0].quarantined);
  EXPECT_EQ(from[1].seq, 3);
  EXPECT_TRUE(database_.ApplicationsFrom(9).empty());
}

TEST_F(FakeStoreFaults, KeepsOrdersForSweepsFromTheOthers) {
  store_.FailNextSweeps(1, FailAt::kBefore);
  store_.FailNext(1, FailAt::kBefore);
  EXPECT_FALSE(store_.Sweep(FromUnixMs(1)).ok());
  const absl::StatusOr<storage::Swept> swept = store_.Sweep(FromUnixMs(1));
  ASSERT_TRUE(swept.ok()) << swept.status();
  EXPECT_EQ(swept->items, 0U);
  EXPECT_FALSE(store_.Commit(Numbers(1, 1)).ok());
  store_.FailNextSweeps(5, FailAt::kAfter);
  EXPECT_FALSE(store_.Sweep(FromUnixMs(1)).ok());
  store_.Heal();
  EXPECT_TRUE(store_.Sweep(FromUnixMs(1)).ok());
  EXPECT_EQ(store_.sweeps(), 4U);
}

TEST_F(FakeStoreFaults, ShowsTheCursorOfPresenceUnderTheServersName) {
  storage::Batch batch;
  batch.presence = {{robot_, model::Presence::kOnline, FromUnixMs(1), 4, hold_}};
  batch.presence_session = session_;
  EXPECT_EQ(database_.Cursor(storage::kServerRuri, session_), std::nullopt);
  ASSERT_TRUE(store_.Commit(batch).ok());
  EXPECT_EQ(database_.Cursor(storage::kServerRuri, session_), 4);
  EXPECT_EQ(database_.Cursor(robot_->ruri, session_), std::nullopt);
}

TEST_F(FakeStoreFaults, StoresTwiceOnlyWhenTheCursorMayBeLowered) {
  for (const bool lowering : {false, true}) {
    FakeDatabase database;
    FakeStore store(database, {1});
    FakeRules rules;
    rules.allow_cursor_lowering = lowering;
    store.SetRules(rules);
    Open(store);
    for (const auto& batch : {Numbers(1, 5), Numbers(2, 3), Numbers(4, 5)}) {
      ASSERT_TRUE(store.Commit(batch).ok());
    }
    EXPECT_EQ(database.TimesWritten(robot_->ruri, session_, 5), lowering ? 2 : 1);
  }
}

TEST_F(FakeStoreFaults, BlocksUntilReleased) {
  store_.Block();
  EXPECT_FALSE(store_.WaitUntilBlocked(milliseconds(0)));
  std::jthread writer([this] { EXPECT_TRUE(store_.Commit(Numbers(1, 1)).ok()); });
  ASSERT_TRUE(store_.WaitUntilBlocked(std::chrono::seconds(10)));
  EXPECT_EQ(database_.ApplicationCount(), 0);
  store_.Release();
  writer.join();
  EXPECT_EQ(database_.ApplicationCount(), 1);
}

}  // namespace
}  // namespace uplink::testing
