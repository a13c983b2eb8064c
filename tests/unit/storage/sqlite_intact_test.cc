// Files of the store that keep their names, and are written over, cut short or damaged.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/sqlite/parts.h"
#include "storage/sqlite/reader.h"
#include "storage/sqlite/store.h"
#include "storage/sqlite/store_files.h"
#include "tests/support/sqlite_shell.h"
#include "tests/unit/storage/fault_store.h"

namespace uplink::storage::sqlite {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kSaysWhatToDo =
    ". See \"The file was overwritten or damaged\" of docs/operate/sqlite.md in "
    "/usr/share/doc/uplinkd";

std::string BytesOf(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

class SqliteIntact : public FaultStore {
 protected:
  void SetUp() override {
    FaultStore::SetUp();
    OpenStore(path_);
    CommitMany(kSome);
  }

  void CommitMany(model::Seq count) {
    for (model::Seq i = 0; i < count; ++i) {
      const auto outcomes = Commit(++seq_);
      ASSERT_TRUE(outcomes.ok()) << outcomes.status();
      ASSERT_EQ(outcomes->front().kind, OutcomeKind::kStored);
    }
  }
  void ExpectFailsForGood(const std::string& name) {
    ExpectFails(seq_ + 1, name);
    ExpectFails(seq_ + 1, name);
    EXPECT_TRUE(fs::exists(Mark()));
  }
  /// As `cp` does it: the file stays, what is in it goes.
  void CopyOver(const std::string& from) const {
    const std::string bytes = BytesOf(from);
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << bytes;
  }
  void WriteZeros(const std::string& path, std::int64_t at, std::size_t bytes) const {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(at);
    file << std::string(bytes, '\0');
  }
  [[nodiscard]] std::string Wal() const { return path_ + "-wal"; }
  [[nodiscard]] std::string Mark() const { return path_ + ".damaged"; }
  [[nodiscard]] absl::Status OpenAgain() const {
    StoreOptions options;
    options.process = {2};
    return SqliteStore::Open(path_, options).status();
  }

  static constexpr model::Seq kSome = 40;
  model::Seq seq_ = 0;
};

TEST_F(SqliteIntact, ACopyOverTheFileAcksNothingAndAStopLeavesItAsItIs) {
  Shell(path_, ".backup '" + aside_ + "'");
  CommitMany(kSome);
  Shell(path_, "PRAGMA wal_checkpoint(TRUNCATE)");
  CommitMany(1);
  CopyOver(aside_);
  ExpectFailsForGood(path_);
  store_.reset();
  EXPECT_EQ(BytesOf(path_), BytesOf(aside_)) << "no row of the other file was moved into it";

  // As docs/operate/sqlite.md has it.
  fs::remove(Wal());
  fs::remove(path_ + "-shm");
  OpenStore(path_);
  EXPECT_FALSE(fs::exists(Mark()));
  EXPECT_EQ(Commit(kSome)->front().kind, OutcomeKind::kDuplicate);
  EXPECT_EQ(Commit(kSome + 1)->front().kind, OutcomeKind::kStored);
}

TEST_F(SqliteIntact, AFileThatIsCutShortAcksNothing) {
  for (const int kept_in_8 : {0, 1, 4, 7}) {
    Shell(path_, "PRAGMA wal_checkpoint(TRUNCATE)");
    CommitMany(1);
    fs::copy_file(path_, aside_, fs::copy_options::overwrite_existing);
    fs::resize_file(path_, fs::file_size(path_) * static_cast<std::uintmax_t>(kept_in_8) / 8);
    ExpectFailsForGood(path_);
    store_.reset();
    CopyOver(aside_);
    OpenStore(path_);
  }
}

TEST_F(SqliteIntact, AWalThatIsCutShortAcksNothing) {
  for (const int kept_in_4 : {0, 1, 3}) {
    CommitMany(3);
    fs::resize_file(Wal(), fs::file_size(Wal()) * static_cast<std::uintmax_t>(kept_in_4) / 4);
    ExpectFailsForGood(Wal());
    store_.reset();
    seq_ = 1'000 * (static_cast<model::Seq>(kept_in_4) + 1);
    OpenStore(path_);
  }
}

TEST_F(SqliteIntact, AWalThatIsWrittenOverAcksNothing) {
  const auto size = static_cast<std::int64_t>(fs::file_size(Wal()));
  WriteZeros(Wal(), size - 4'120, 24);
  ExpectFailsForGood(Wal());
}

// Frames that were written behind a hole are lost by the next start with those in it.
TEST_F(SqliteIntact, AWalThatIsCutShortDuringACommitAcksNothing) {
  for (const bool after : {false, true}) {
    store_.reset();
    std::function<void()> meanwhile = [] {};
    const auto cut = [&] {
      std::exchange(meanwhile, [] {})();
      return absl::OkStatus();
    };
    StoreOptions options;
    (after ? options.after_commit : options.before_commit) = cut;
    OpenStore(path_, options);
    seq_ += 100;
    CommitMany(kSome);
    meanwhile = [&] { fs::resize_file(Wal(), fs::file_size(Wal()) / 2); };
    ExpectFailsForGood(Wal());
    seq_ += 100;
  }
}

// A page that only a reader reads: the writer may have it in memory.
TEST_F(SqliteIntact, WhatAReaderFindsDamagedEndsTheAcks) {
  Shell(path_, "PRAGMA wal_checkpoint(TRUNCATE)");
  fs::copy_file(path_, aside_);
  ReaderOptions reads;
  reads.damage = store_->damage();
  const auto reader = SqliteReader::Open(path_, reads);
  ASSERT_TRUE(reader.ok()) << reader.status();
  const auto bytes = static_cast<std::int64_t>(fs::file_size(path_));
  WriteZeros(path_, 4'096, static_cast<std::size_t>(bytes - 4'096));
  EXPECT_EQ((*reader)->RobotCount().status().code(), absl::StatusCode::kDataLoss);
  ExpectFailsForGood(path_);

  store_.reset();
  const absl::Status damaged = OpenAgain();
  EXPECT_EQ(damaged.code(), absl::StatusCode::kFailedPrecondition) << damaged;
  EXPECT_THAT(std::string(damaged.message()), HasSubstr(path_));
  CopyOver(aside_);
  EXPECT_TRUE(OpenAgain().ok()) << OpenAgain();
}

TEST_F(SqliteIntact, AStartTellsThatItReadsTheWholeFileAndWhatItFound) {
  Shell(path_, "PRAGMA wal_checkpoint(TRUNCATE)");
  store_.reset();
  using Step = DamageCheck::Step;
  std::vector<std::pair<Step, std::uint64_t>> told;
  StoreOptions options;
  options.process = {2};
  options.on_damage_check = [&](const DamageCheck& check) {
    told.emplace_back(check.step, check.bytes);
    EXPECT_EQ(fs::exists(Mark()), true) << "it stays until the end";
  };
  EXPECT_TRUE(SqliteStore::Open(path_, options).ok());
  EXPECT_THAT(told, ::testing::IsEmpty()) << "no damage was found";

  const std::uint64_t bytes = fs::file_size(path_);
  std::ofstream(Mark()).close();
  EXPECT_TRUE(SqliteStore::Open(path_, options).ok());
  EXPECT_THAT(told, ::testing::ElementsAre(std::pair(Step::kBegins, bytes),
                                           std::pair(Step::kSound, bytes)));
  told.clear();
  std::ofstream(Mark()).close();
  WriteZeros(path_, 4'096, static_cast<std::size_t>(bytes - 4'096));
  EXPECT_FALSE(SqliteStore::Open(path_, options).ok());
  EXPECT_THAT(told, ::testing::ElementsAre(std::pair(Step::kBegins, bytes),
                                           std::pair(Step::kFailed, bytes)));
}

// No server ran when the file was damaged, so no start was told to read all of it.
TEST_F(SqliteIntact, AStartOnADamagedFileSaysWhatToDoAndLeavesItAsItIs) {
  Shell(path_, "PRAGMA wal_checkpoint(TRUNCATE)");
  CommitMany(1);
  const std::string wal = BytesOf(Wal());
  fs::copy_file(path_, aside_);
  store_.reset();
  const auto expect = [&](const absl::Status& status, const std::string& before) {
    EXPECT_FALSE(status.ok());
    EXPECT_THAT(std::string(status.message()),
                AllOf(HasSubstr(path_), HasSubstr("damaged"), HasSubstr(kSaysWhatToDo)));
    EXPECT_EQ(BytesOf(path_), before);
    EXPECT_EQ(BytesOf(Wal()), wal);
  };
  const auto bytes = static_cast<std::int64_t>(fs::file_size(aside_));
  struct Hole {
    std::int64_t from = 0;
    std::int64_t to = 0;
    bool ours = true;
  };
  // All but the first page, the schema's root, and the header.
  for (const Hole& hole : {Hole{4'096, bytes}, Hole{100, 4'096}, Hole{0, 4'096, false}}) {
    SCOPED_TRACE(hole.from);
    CopyOver(aside_);
    std::ofstream(Wal(), std::ios::binary | std::ios::trunc) << wal;
    WriteZeros(path_, hole.from, static_cast<std::size_t>(hole.to - hole.from));
    fs::remove(Mark());
    const std::string before = BytesOf(path_);
    expect(OpenForgetStore(path_).status(), before);
    EXPECT_FALSE(fs::exists(Mark()));
    expect(OpenAgain(), before);
    EXPECT_EQ(fs::exists(Mark()), hole.ours) << "the next start reads all of it";
    expect(OpenAgain(), before);
  }
}

TEST_F(SqliteIntact, WhatADutyFindsDamagedEndsTheAcks) {
  Shell(path_, "PRAGMA wal_checkpoint(TRUNCATE)");
  const auto forget = OpenForgetStore(path_, store_->damage());
  ASSERT_TRUE(forget.ok()) << forget.status();
  const auto bytes = static_cast<std::int64_t>(fs::file_size(path_));
  WriteZeros(path_, 4'096, static_cast<std::size_t>(bytes - 4'096));
  EXPECT_FALSE((*forget)->requests().Pending().ok());
  ExpectFailsForGood(path_);
}

TEST_F(SqliteIntact, AnOlderStateThatIsRestoredByTheRulesAcksNothing) {
  Shell(path_, ".backup '" + aside_ + "'");
  Shell(path_, ".restore '" + aside_ + "'");
  CommitMany(1);  // the same state: nothing is missing
  Shell(path_, ".restore '" + aside_ + "'");
  ExpectFailsForGood(path_ + " went back");
}

TEST_F(SqliteIntact, AnOlderStateThatIsRestoredBeforeAStartsFirstCommitAcksNothing) {
  Shell(path_, ".backup '" + aside_ + "'");
  CommitMany(1);
  store_.reset();
  OpenStore(path_);
  Shell(path_, ".restore '" + aside_ + "'");
  ExpectFailsForGood(path_ + " went back");
}

// The checkpoint of another program ends where it would make the file longer.
TEST_F(SqliteIntact, ACopyOverTheFileAfterACheckpointThatFailedAcksNothing) {
  Shell(path_, ".backup '" + aside_ + "'");
  Shell(path_, "PRAGMA wal_checkpoint(TRUNCATE)");
  const std::uintmax_t bytes = fs::file_size(path_);
  CommitMany(500);
  const std::string command = "ulimit -f " + std::to_string(bytes / 512) + "; sqlite3 '" + path_ +
                              "' 'PRAGMA wal_checkpoint' >'" + folder_.File("out") + "' 2>&1";
  // NOLINTNEXTLINE(cert-env33-c,concurrency-mt-unsafe): the command is ours, and no thread runs
  EXPECT_NE(std::system(command.c_str()), 0) << "it came to its end";
  CommitMany(1);
  CopyOver(aside_);
  ExpectFailsForGood(path_);
}

// SQLite would delete the WAL as it opens the file, and with it what was acked.
TEST_F(SqliteIntact, AStartOnAnEmptiedFileIsRefusedAndChangesNothing) {
  fs::copy_file(Wal(), aside_);
  store_.reset();
  const auto expect_refused = [this](const std::string& named) {
    const absl::Status status = OpenAgain();
    EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(named + " beside it"));
  };
  for (const bool missing : {false, true}) {
    fs::resize_file(path_, 0);
    if (missing) fs::remove(path_);
    fs::copy_file(aside_, Wal());
    expect_refused(Wal());
    EXPECT_EQ(BytesOf(Wal()), BytesOf(aside_));
    fs::remove(Wal());
    std::ofstream(Mark()).close();
    expect_refused(Mark());
    fs::remove(Mark());
    EXPECT_TRUE(OpenAgain().ok()) << OpenAgain();
  }
}

// Each is a program of its own, and ends as the only one or beside the store.
TEST_F(SqliteIntact, WhatOtherProgramsDoByTheRulesIsNoDamage) {
  // Over 1,000 frames, so that the other program moves them into the file by itself.
  const std::string grow =
      "CREATE TABLE theirs (a); WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n"
      " WHERE i < 1500) INSERT INTO theirs SELECT zeroblob(3500) FROM n;";
  const std::string shrink = "DROP TABLE theirs; VACUUM;";
  const std::vector<std::string> works = {
      "SELECT 1",
      ".backup '" + aside_ + "'",
      "VACUUM INTO '" + folder_.File("into") + "'",
      "PRAGMA wal_checkpoint(PASSIVE)",
      "PRAGMA wal_checkpoint(FULL)",
      "PRAGMA wal_checkpoint(RESTART)",
      "PRAGMA wal_checkpoint(TRUNCATE)",
      grow,
      shrink,
      grow + "PRAGMA wal_checkpoint(TRUNCATE)",
      shrink + "PRAGMA wal_checkpoint(TRUNCATE);" + grow,
      shrink + "PRAGMA wal_checkpoint(PASSIVE)",
      "PRAGMA journal_size_limit = 0; PRAGMA wal_checkpoint(RESTART); CREATE TABLE theirs (a)",
      shrink + "PRAGMA integrity_check",
  };
  for (const std::string& work : works) {
    Shell(path_, work);
    CommitMany(1);
    CommitMany(1);
  }
  EXPECT_FALSE(fs::exists(Mark()));
}

TEST_F(SqliteIntact, ConnectionsThatCommitAndCheckpointMeanwhileAreNoDamage) {
  std::jthread other([this](const std::stop_token& stop) {
    testing::SqliteShell shell(path_);
    shell.Run("PRAGMA busy_timeout = 5000");
    shell.Run("PRAGMA synchronous = OFF");
    shell.Run("CREATE TABLE theirs (a)");
    for (int i = 0; !stop.stop_requested(); ++i) {
      static_cast<void>(shell.TryRun("INSERT INTO theirs SELECT zeroblob(20000)"));
      static_cast<void>(shell.TryRun(i % 3 == 0   ? "PRAGMA wal_checkpoint(RESTART)"
                                     : i % 3 == 1 ? "PRAGMA wal_checkpoint(TRUNCATE)"
                                                  : "PRAGMA wal_checkpoint(PASSIVE)"));
      if (i % 50 == 49) static_cast<void>(shell.TryRun("DELETE FROM theirs"));
    }
  });
  CommitMany(300);
}

TEST_F(SqliteIntact, ALongWalIsMovedIntoTheFile) {
  Shell(path_, "PRAGMA wal_checkpoint(TRUNCATE)");
  std::uintmax_t longest = 0;
  for (int i = 0; i < 400; ++i) {
    CommitMany(1);
    longest = std::max(longest, fs::file_size(Wal()));
  }
  EXPECT_GE(longest, 1'000U * 4'120) << "it was long enough";
  EXPECT_LT(longest, 2U * kMovedAtFrames * 4'120);
}

}  // namespace
}  // namespace uplink::storage::sqlite
