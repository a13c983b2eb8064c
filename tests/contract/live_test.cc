#include <gmock/gmock.h>

#include "tests/contract/store_contract.h"

/// Checkpoints of live state, alike in every store.
namespace uplink::testing {
namespace {

using storage::LivePart;
using storage::LiveRow;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::optional<std::string>& Part(LiveRow& row, LivePart part) {
  return row.parts[static_cast<std::size_t>(part)];
}

class LiveContract : public StoreContract {
 protected:
  LiveRow Row(const std::string& motion = "m") const {
    LiveRow row;
    row.ruri = robot_->ruri;
    row.held_since = held_since_;
    row.last_sign_of_life = Time();
    Part(row, LivePart::kMotion) = motion;
    return row;
  }
  std::vector<std::size_t> PassedOver(const std::vector<LiveRow>& rows,
                                      std::uint8_t process = kProcess) {
    const auto passed_over = store_->Process(process).Checkpoint(rows);
    EXPECT_TRUE(passed_over.ok()) << passed_over.status();
    return passed_over.value_or(std::vector<std::size_t>());
  }
  std::size_t Write(const std::vector<LiveRow>& rows, std::uint8_t process = kProcess) {
    const auto passed_over = PassedOver(rows, process);
    return rows.size() - passed_over.size();
  }
  storage::Reader::LiveRows ReadOf(const std::vector<std::string>& ruris) {
    auto live = store_->reader().LiveOf(ruris);
    EXPECT_TRUE(live.ok()) << live.status();
    return live.ok() ? *std::move(live) : storage::Reader::LiveRows();
  }
  std::vector<LiveRow> Read() { return ReadOf({robot_->ruri}).rows; }
};

TEST_P(LiveContract, KeepsAllPartsAsTheyCame) {
  Open();
  LiveRow row = Row();
  row.clock_skew_ms = -1'234;
  for (std::size_t kind = 0; kind < storage::kLivePartKinds; ++kind) {
    row.parts[kind] = std::string("\0\xFF'\\", 4) + std::to_string(kind);
  }
  EXPECT_EQ(Write({row}), 1U);
  EXPECT_THAT(Read(), ElementsAre(row));
}

TEST_P(LiveContract, PassesOverARobotThatHasNoRow) {
  Open();
  EXPECT_EQ(Write({Row("first")}), 1U);
  store_->DeleteRobotRow(robot_->ruri);
  EXPECT_THAT(PassedOver({Row("second")}), ElementsAre(0U));
  EXPECT_EQ(*store_->reader().RobotCount(), 0U);
  EXPECT_THAT(Read(), ElementsAre(Row("first")));
  Open();
  EXPECT_EQ(Write({Row("third")}), 1U);
}

TEST_P(LiveContract, RobotsAreListedWithTheirLastSessionAsFarAsACheckpointSaysItIsSettled) {
  Open();
  Commit({Good(5)});
  const auto settled = [this] {
    const auto rows = store_->reader().Robots(10);
    EXPECT_TRUE(rows.ok() && rows->front().last_session) << rows.status();
    return rows.ok() && rows->front().last_session ? rows->front().last_session->settled_seq : 0;
  };
  const auto checkpoint = [this](const model::SessionId& session, model::Seq seq,
                                 std::uint8_t process = kProcess) {
    LiveRow row;
    row.ruri = robot_->ruri;
    row.held_since = held_since_;
    row.session = {session, seq};
    Write({row}, process);
  };
  Write({Row()});
  EXPECT_EQ(settled(), 5U) << "a checkpoint that says nothing of it";
  checkpoint(session_, 9);
  EXPECT_EQ(settled(), 9U);
  EXPECT_THAT(Read(), ElementsAre(Row())) << "no part of the live state";
  Write({Row("again")});
  EXPECT_EQ(settled(), 9U) << "what a write leaves unset stays";
  checkpoint(session_, 20, kOther);
  EXPECT_EQ(settled(), 9U) << "another process has nothing to say";
  Commit({Good(12)});
  EXPECT_EQ(settled(), 12U) << "the cursor at least";
  checkpoint(Session(9), 30);
  EXPECT_EQ(settled(), 12U) << "of another session";
  EXPECT_EQ(CursorNow(), 12U) << "what is new decides the cursor alone";
}

TEST_P(LiveContract, WhatDidNotChangeStays) {
  Open();
  LiveRow row = Row("first");
  row.clock_skew_ms = 7;
  Part(row, LivePart::kExtras) = std::string(100'000, 'e');
  Write({row});
  LiveRow changed = Row("second");
  changed.last_sign_of_life = Time(5'000);
  Part(changed, LivePart::kStatus) = "";
  Write({changed});
  changed.clock_skew_ms = 7;
  Part(changed, LivePart::kExtras) = std::string(100'000, 'e');
  EXPECT_THAT(Read(), ElementsAre(changed));
  LiveRow nothing;
  nothing.ruri = robot_->ruri;
  nothing.held_since = held_since_;
  EXPECT_EQ(Write({nothing}), 1U);
  EXPECT_THAT(Read(), ElementsAre(changed));
}

TEST_P(LiveContract, ARobotWithoutASignOfLifeHasNone) {
  Open();
  LiveRow row;
  row.ruri = robot_->ruri;
  row.held_since = held_since_;
  Write({row});
  EXPECT_THAT(Read(), ElementsAre(row));
}

TEST_P(LiveContract, PassesOverRobotsThatAnotherProcessHolds) {
  const auto robot_b = Robot("b");
  Open();
  LiveRow unknown = Row();
  unknown.ruri = "rcan://robots/unknown";
  const LiveRow ours = Row("ours");
  EXPECT_THAT(PassedOver({unknown, ours}), ElementsAre(0U));
  const LiveRow late = Row("late");
  held_since_ = Open(Request(), kOther).held_since;
  EXPECT_EQ(Write({late}), 0U);
  EXPECT_THAT(Read(), ElementsAre(ours));
  EXPECT_EQ(Write({Row("theirs")}, kOther), 1U);
  EXPECT_THAT(Read(), ElementsAre(Row("theirs")));
}

TEST_P(LiveContract, PassesOverWhatIsOfAnEarlierHold) {
  Open();
  const LiveRow first = Row("first");
  EXPECT_EQ(Write({first}), 1U);
  held_since_ = Open(Request(), kOther).held_since;
  const LiveRow theirs = Row("theirs");
  EXPECT_EQ(Write({theirs}, kOther), 1U);
  held_since_ = Open().held_since;
  EXPECT_EQ(Write({first}), 0U) << "this process holds it again, since later";
  EXPECT_THAT(Read(), ElementsAre(theirs));
  EXPECT_EQ(Write({Row("again")}), 1U);
  EXPECT_THAT(Read(), ElementsAre(Row("again")));
}

TEST_P(LiveContract, AnAnswerEndsWhereItsBytesAreMany) {
  std::vector<LiveRow> rows;
  std::vector<std::string> ruris;
  for (const char* name : {"a", "b", "c", "d"}) {
    LiveRow row = Row();
    ruris.push_back(row.ruri = Robot(name)->ruri);
    const storage::OpenRequest request{Robot(name), session_, 0, Time(), {}};
    row.held_since = Open(request).held_since;
    // The third has no state.
    if (std::string_view(name) == "c") continue;
    Part(row, LivePart::kDirectives) = std::string(storage::kPageBytesMax / 2 + 1, 'd');
    rows.push_back(std::move(row));
  }
  for (const LiveRow& row : rows) Write({row});
  const auto first = ReadOf(ruris);
  EXPECT_THAT(first.rows, SizeIs(2));
  EXPECT_EQ(first.complete, 2U);
  const auto rest = ReadOf({ruris[2], ruris[3]});
  EXPECT_THAT(rest.rows, ElementsAre(rows[2]));
  EXPECT_EQ(rest.complete, 2U);
  EXPECT_THAT(ReadOf({ruris[2]}).rows, IsEmpty());
}

TEST_P(LiveContract, HoldsAfterAReopening) {
  Open();
  Write({Row()});
  store_->Reopen();
  EXPECT_THAT(Read(), ElementsAre(Row()));
  EXPECT_EQ(Write({}), 0U);
}

INSTANTIATE_TEST_SUITE_P(Stores, LiveContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
