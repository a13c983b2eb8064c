#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/bounds.h"
#include "storage/sqlite/store.h"
#include "tests/support/records.h"
#include "tests/support/sqlite_shell.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/schema/samples.h"

/// The durable kinds in a file: rows that SQLite refuses, the sweep's bound.
namespace uplink::storage::sqlite {
namespace {

using ::testing::HasSubstr;
using testing::SqliteShell;

class SqliteKinds : public ::testing::Test {
 protected:
  void Open() {
    store_.reset();
    StoreOptions options;
    options.process = {1};
    auto opened = SqliteStore::Open(path_, options);
    ASSERT_TRUE(opened.ok()) << opened.status();
    store_ = *std::move(opened);
    const std::vector<OpenRequest> requests = {{.robot = robot_, .session = session_, .at = now_}};
    const auto stream = store_->OpenStreams(requests);
    ASSERT_TRUE(stream.ok()) << stream.status();
    held_since_ = stream->front().held_since;
  }

  CommitRecord Record(const model::Body& body) {
    return {.robot = robot_,
            .session = session_,
            .seq = ++seq_,
            .held_since = held_since_,
            .received_at = now_,
            .content = test::RecordOf(body)};
  }

  testing::TempFolder folder_;
  const std::string path_ = folder_.File("uplinkd.db");
  const RobotRef robot_ =
      std::make_shared<const model::RobotId>(model::RobotId{.ruri = "rcan://r/1", .fleet = "f"});
  const model::SessionId session_{std::array<std::uint8_t, 16>{7}};
  const SystemTime now_ = FromUnixMs(test::kSampleMs);
  std::unique_ptr<SqliteStore> store_;
  Epoch held_since_ = 0;
  model::Seq seq_ = 0;
};

class RefusedKinds : public SqliteKinds, public ::testing::WithParamInterface<const char*> {};

// A row that SQLite will not take stands aside alone: its neighbours of every kind are stored.
TEST_P(RefusedKinds, ARowThatTheFileRefusesIsSetAside) {
  Open();
  SqliteShell shell(path_);
  shell.Run("CREATE TRIGGER refuse BEFORE INSERT ON " + std::string(GetParam()) +
            " BEGIN SELECT RAISE(ABORT, 'the test says so'); END");
  Batch batch;
  for (const model::Body& body : test::SampleBodies()) {
    if (model::IsDurable(model::VariantOf(body))) batch.records.push_back(Record(body));
  }
  const auto outcomes = store_->Commit(batch);
  ASSERT_TRUE(outcomes.ok()) << outcomes.status();
  std::size_t refused = 0;
  for (const Outcome& outcome : *outcomes) {
    if (outcome.kind == OutcomeKind::kStored) continue;
    ++refused;
    EXPECT_EQ(outcome.kind, OutcomeKind::kRefused);
    ASSERT_TRUE(outcome.rejection);
    EXPECT_EQ(outcome.rejection->reason, model::RejectReason::kStoreRefused);
    EXPECT_THAT(outcome.rejection->detail, HasSubstr("the test says so"));
  }
  const bool latest = std::string(GetParam()) == "latest";
  EXPECT_EQ(refused, latest ? kLatestKinds : 1U);
  EXPECT_EQ(shell.Read("SELECT COUNT(*) FROM quarantine"), std::to_string(refused) + "\n");
  EXPECT_EQ(shell.Read("SELECT COUNT(*) FROM " + std::string(GetParam())), "0\n");
  // What the kind writes beside that table is taken back with it.
  for (const char* beside : {"mission_runs", "mission_reports"}) {
    const bool together = std::string(GetParam()).starts_with("mission");
    EXPECT_EQ(shell.Read("SELECT COUNT(*) FROM " + std::string(beside)), together ? "0\n" : "1\n");
  }
}

INSTANTIATE_TEST_SUITE_P(Tables, RefusedKinds,
                         ::testing::Values("events", "messages", "mission_reports", "mission_runs",
                                           "shapes", "objects", "latest"),
                         [](const auto& name) { return std::string(name.param); });

TEST_F(SqliteKinds, ASweepDeletesNoMoreThanItsBound) {
  Open();
  SqliteShell shell(path_);
  const std::string rows = std::to_string(kSweepRowsMax + 1);
  shell.Run(
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < " + rows +
      ") INSERT INTO shapes SELECT 'rcan://r/1', i, 'f', 1, i, 1, 2, '', 0, '', 0, 0, 0, 0, 0,"
      " '{}' FROM n");
  const SystemTime later = FromUnixMs(2) + kExpiredKept;
  EXPECT_EQ(store_->Sweep(later - milliseconds(1))->items, 0U);
  EXPECT_EQ(store_->Sweep(later)->items, kSweepRowsMax);
  EXPECT_EQ(store_->Sweep(later)->items, 1U);
  EXPECT_EQ(store_->Sweep(later)->items, 0U);
}

}  // namespace
}  // namespace uplink::storage::sqlite
