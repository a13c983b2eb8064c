#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "storage/sqlite/reader.h"
#include "storage/sqlite/store.h"
#include "tests/support/records.h"
#include "tests/support/sqlite_shell.h"
#include "tests/support/temp_folder.h"

namespace uplink::storage::sqlite {
namespace {

using ::testing::HasSubstr;
using testing::SqliteShell;

/// No file of this process grows past `bytes` while this lives; writes fail as on a broken disk.
class FileSizeLimit final {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit old_{};
  void (*old_handler_)(int) = nullptr;
};

class SqliteTrouble : public ::testing::Test {
 protected:
  void OpenStore(StoreOptions options = {}) {
    options.process = {1};
    auto opened = SqliteStore::Open(path_, options);
    ASSERT_TRUE(opened.ok()) << opened.status();
    store_ = *std::move(opened);
    const OpenRequest request{robot_, {}, 0, FromUnixMs(1), {}};
    ASSERT_TRUE(store_->OpenStreams({&request, 1}).ok());
  }

  Batch Faults(model::Seq first, std::size_t count) const {
    Batch batch;
    for (model::Seq seq = first; seq < first + count; ++seq) {
      model::Fault fault;
      fault.fault_id = "f" + std::to_string(seq);
      fault.active = true;
      fault.description = std::string(4000, 'd');
      batch.records.push_back(
          {robot_, {}, seq, 1, FromUnixMs(1), test::RecordOf(fault), "bytes", 5});
    }
    return batch;
  }

  std::string Count(const std::string& table) const {
    return SqliteShell(path_).Read("SELECT COUNT(*) FROM " + table);
  }

  testing::TempFolder folder_;
  const std::string path_ = folder_.File("uplinkd.db");
  const RobotRef robot_ = std::make_shared<const model::RobotId>(model::RobotId{"rcan://r", "f"});
  std::unique_ptr<SqliteStore> store_;
};

TEST_F(SqliteTrouble, SaysThatTheStoreIsFullAndRecovers) {
  StoreOptions options;
  // The empty schema and what is small fit; what is large does not.
  options.pages_max = 190;
  OpenStore(options);
  const Batch small = Faults(1, 10);
  ASSERT_TRUE(store_->Commit(small).ok());
  const Batch large = Faults(11, 60);
  const absl::Status full = store_->Commit(large).status();
  EXPECT_EQ(full.code(), absl::StatusCode::kResourceExhausted) << full;
  EXPECT_THAT(std::string(full.message()), HasSubstr(path_));
  EXPECT_EQ(Count("faults_history"), "10\n") << "all or nothing";
  // Who keeps asking is told the same, and what fits is still taken.
  EXPECT_EQ(store_->Commit(large).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_TRUE(store_->Commit(small).ok());
  store_.reset();
  OpenStore();  // with room
  const auto outcomes = store_->Commit(large);
  ASSERT_TRUE(outcomes.ok()) << outcomes.status();
  EXPECT_EQ(outcomes->back().kind, OutcomeKind::kStored);
  EXPECT_EQ(Count("faults_history"), "70\n");
}

TEST_F(SqliteTrouble, RecoversWithoutARestartOnceThereIsRoomAgain) {
  OpenStore();
  const Batch batch = Faults(1, 200);
  {
    const FileSizeLimit limit(std::filesystem::file_size(path_ + "-wal") + 20'000);
    const absl::Status status = store_->Commit(batch).status();
    EXPECT_TRUE(absl::IsUnavailable(status) || absl::IsResourceExhausted(status)) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(path_));
    EXPECT_FALSE(store_->Commit(batch).ok());
  }
  EXPECT_EQ(Count("faults_history"), "0\n");
  const auto outcomes = store_->Commit(batch);
  ASSERT_TRUE(outcomes.ok()) << outcomes.status();
  EXPECT_EQ(outcomes->back().kind, OutcomeKind::kStored);
  EXPECT_EQ(Count("faults_history"), "200\n");
}

TEST_F(SqliteTrouble, AsksForARetryWhileAnotherConnectionWrites) {
  StoreOptions options;
  options.busy_timeout = milliseconds(1);
  OpenStore(options);
  const Batch batch = Faults(1, 1);
  {
    SqliteShell shell(path_);
    shell.Run("BEGIN IMMEDIATE");
    const absl::Status status = store_->Commit(batch).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(path_));
  }
  EXPECT_TRUE(store_->Commit(batch).ok());
}

TEST_F(SqliteTrouble, StopsWhenWhatDecidesIsRefused) {
  OpenStore();
  SqliteShell(path_).Run(
      "CREATE TRIGGER refuse BEFORE UPDATE ON sessions BEGIN SELECT RAISE(ABORT, 'no'); END");
  EXPECT_EQ(store_->Commit(Faults(1, 1)).status().code(), absl::StatusCode::kInternal);
  EXPECT_EQ(Count("faults_history"), "0\n");
}

TEST_F(SqliteTrouble, RefusesASessionThatIsNone) {
  OpenStore();
  SqliteShell(path_).Run(
      "INSERT INTO sessions (ruri, session, cursor_seq, last_used, first_entry)"
      " VALUES ('rcan://r', x'0102', 0, 0, 0)");
  const OpenRequest request{robot_, model::SessionId({2}), 0, FromUnixMs(2), {}};
  const absl::Status status = store_->OpenStreams({&request, 1}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInternal) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("not 16 bytes"));
  EXPECT_EQ(Count("sessions"), "2\n") << "none was evicted for it, and none was added";
}

TEST_F(SqliteTrouble, KeepsABareQuarantineRowWhereThePayloadIsRefused) {
  OpenStore();
  SqliteShell(path_).Run(
      "CREATE TRIGGER refuse BEFORE INSERT ON quarantine WHEN NEW.payload IS NOT NULL"
      " OR NEW.detail <> '' BEGIN SELECT RAISE(ABORT, 'no'); END");
  Batch batch = Faults(1, 1);
  batch.records[0].content = QuarantineItem{{model::RejectReason::kMalformed, "x", "detail"}};
  const auto outcomes = store_->Commit(batch);
  ASSERT_TRUE(outcomes.ok()) << outcomes.status();
  EXPECT_EQ(outcomes->front().kind, OutcomeKind::kStored);
  EXPECT_EQ(SqliteShell(path_).Read("SELECT seq, reason, field, detail, payload, payload_bytes"
                                    " FROM quarantine"),
            "1|1|||NULL|5\n");
}

TEST_F(SqliteTrouble, CommitsWhileAReadIsUnderWay) {
  OpenStore();
  ASSERT_TRUE(store_->Commit(Faults(1, 5)).ok());
  SqliteShell reader(path_);
  reader.Run("BEGIN");
  EXPECT_EQ(reader.Read("SELECT COUNT(*) FROM faults_history"), "5\n");
  EXPECT_TRUE(store_->Commit(Faults(6, 1)).ok());
  EXPECT_EQ(reader.Read("SELECT COUNT(*) FROM faults_history"), "5\n");
}

TEST_F(SqliteTrouble, StopsAReadAtItsLimit) {
  OpenStore();
  ASSERT_TRUE(store_->Commit(Faults(1, 500)).ok());
  ReaderOptions options;
  options.steps_max = 1'000;
  auto reader = SqliteReader::Open(path_, options);
  ASSERT_TRUE(reader.ok()) << reader.status();
  HistoryQuery query;
  query.page_size = kPageSizeMax;
  const absl::Status status = (*reader)->FaultHistory({.rows = query}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded) << status;
  query.page_size = 1;
  EXPECT_TRUE((*reader)->FaultHistory({.rows = query}).ok()) << "each call has the whole limit";
  EXPECT_TRUE((*reader)->FaultHistory({.rows = query}).ok());
}

TEST_F(SqliteTrouble, ShowsAReasonThatANewerProgramWroteAsTheStoresOwn) {
  OpenStore();
  SqliteShell(path_).Run(
      "INSERT INTO quarantine VALUES ('rcan://r', zeroblob(16), 1, 1, 'f', 1, 99, '', '', 0, "
      "NULL, 99, '')");
  auto reader = SqliteReader::Open(path_);
  ASSERT_TRUE(reader.ok()) << reader.status();
  const auto page = (*reader)->Quarantine({});
  ASSERT_TRUE(page.ok()) << page.status();
  ASSERT_EQ(page->rows.size(), 1U);
  EXPECT_EQ(page->rows[0].rejection.reason, model::RejectReason::kStoreRefused);
  EXPECT_EQ(page->rows[0].source, model::MessageSource::kUplink);
}

TEST_F(SqliteTrouble, KeepsItsWalWhenAnotherProgramOpensAndClosesTheFile) {
  OpenStore();
  const auto reader = SqliteReader::Open(path_);
  ASSERT_TRUE(reader.ok()) << reader.status();
  ASSERT_TRUE(store_->Commit(Faults(1, 1)).ok());
  // A program of its own: locks of the same process would not show what it does.
  const std::string shell = "sqlite3 '" + path_ + "' 'SELECT COUNT(*) FROM faults_history' >'" +
                            folder_.File("out") + "'";
  // NOLINTNEXTLINE(cert-env33-c,concurrency-mt-unsafe): the command is ours, and no thread runs
  ASSERT_EQ(std::system(shell.c_str()), 0);
  EXPECT_TRUE(std::filesystem::exists(path_ + "-wal"))
      << "the other program took itself for the last one";
  ASSERT_TRUE(store_->Commit(Faults(2, 1)).ok());
  const std::string copy = folder_.File("copy.db");
  // What a kill would leave.
  std::filesystem::copy_file(path_, copy);
  std::filesystem::copy_file(path_ + "-wal", copy + "-wal");
  EXPECT_EQ(SqliteShell(copy).Read("SELECT COUNT(*) FROM faults_history"), "2\n");
}

}  // namespace
}  // namespace uplink::storage::sqlite
