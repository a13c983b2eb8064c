// Files of the store whose names are removed, moved or given to others under the server.
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/sqlite/file_lock.h"
#include "storage/sqlite/named_files.h"
#include "storage/sqlite/schema.h"
#include "storage/sqlite/store.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/storage/fault_store.h"

namespace uplink::storage::sqlite {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class SqliteNames : public FaultStore {};

TEST_F(SqliteNames, AFileThatIsRemovedAcksNothing) {
  OpenStore(path_);
  ASSERT_TRUE(Commit(1).ok());
  fs::remove(path_);
  ExpectFails(2, path_);
  EXPECT_FALSE(fs::exists(path_));
}

TEST_F(SqliteNames, AFileThatIsReplacedAcksNothing) {
  OpenStore(path_);
  ASSERT_TRUE(Commit(1).ok());
  Shell(path_, "VACUUM INTO '" + aside_ + "'");
  ASSERT_TRUE(Commit(2).ok()) << "a backup changes nothing";
  fs::rename(aside_, path_);
  ExpectFails(3, path_);
  fs::remove(path_ + "-wal");
  EXPECT_EQ(Faults(path_), "1\n");
}

TEST_F(SqliteNames, AWalThatIsRemovedAcksNothingAndAnOrderlyEndKeepsAll) {
  OpenStore(path_);
  ASSERT_TRUE(Commit(1).ok());
  fs::remove(path_ + "-wal");
  ExpectFails(2, path_ + "-wal");
  store_.reset();
  EXPECT_EQ(Faults(path_), "1\n") << "SQLite moves its open WAL into the file";
  OpenStore(path_);
  EXPECT_TRUE(Commit(2).ok());
}

TEST_F(SqliteNames, AWalThatIsReplacedAcksNothing) {
  OpenStore(path_);
  fs::copy_file(path_ + "-wal", aside_);
  fs::rename(aside_, path_ + "-wal");
  ExpectFails(1, path_ + "-wal");
}

// Else another program takes itself for the first one, and begins the WAL anew under our commits:
// the third fault would be acked, and lost by a kill.
TEST_F(SqliteNames, AnIndexThatIsRemovedAcksNothing) {
  OpenStore(path_);
  ASSERT_TRUE(Commit(1).ok());
  ASSERT_TRUE(Commit(2).ok());
  fs::remove(path_ + "-shm");
  Shell(path_, "PRAGMA wal_checkpoint(RESTART); CREATE TABLE theirs (a)");
  ExpectFails(3, path_ + "-shm");
  // What a kill would leave.
  fs::copy_file(path_, aside_);
  fs::copy_file(path_ + "-wal", aside_ + "-wal");
  EXPECT_EQ(Faults(aside_), "2\n") << "two are acked";
}

TEST_F(SqliteNames, AFolderThatIsMovedAcksNothingUntilItIsBack) {
  OpenStore(path_);
  ASSERT_TRUE(Commit(1).ok());
  fs::rename(real_, aside_);
  ExpectFails(2, path_);
  fs::rename(aside_, real_);
  const auto outcomes = Commit(2);
  ASSERT_TRUE(outcomes.ok()) << outcomes.status();
  EXPECT_EQ(outcomes->front().kind, OutcomeKind::kStored);
  EXPECT_EQ(Faults(path_), "2\n");
}

TEST_F(SqliteNames, ALinkThatLeadsElsewhereAcksNothing) {
  const std::string link = folder_.File("link.db");
  fs::create_symlink(path_, link);
  OpenStore(link);
  ASSERT_TRUE(Commit(1).ok());
  Shell(path_, "VACUUM INTO '" + aside_ + "'");
  fs::remove(link);
  ExpectFails(2, link);
  fs::create_symlink(aside_, link);
  ExpectFails(2, link);
  fs::remove(link);
  fs::create_symlink(path_, link);
  EXPECT_TRUE(Commit(2).ok());
}

// The commit is in a file that no start finds; it is not told, and told once when it is found.
TEST_F(SqliteNames, WhatIsMovedInTheMiddleOfACommitIsToldOnceWhenItIsBack) {
  std::function<void()> meanwhile = [] {};
  for (const bool after : {false, true}) {
    const auto move = [&] {
      std::exchange(meanwhile, [] {})();
      return absl::OkStatus();
    };
    store_.reset();
    StoreOptions options;
    (after ? options.after_commit : options.before_commit) = move;
    OpenStore(path_, options);
    meanwhile = [&] { fs::rename(path_, aside_); };
    const model::Seq seq = after ? 2 : 1;
    EXPECT_EQ(Commit(seq).status().code(), absl::StatusCode::kUnavailable);
    EXPECT_EQ(Commit(seq).status().code(), absl::StatusCode::kUnavailable);
    fs::rename(aside_, path_);
    const auto outcomes = Commit(seq);
    ASSERT_TRUE(outcomes.ok()) << outcomes.status();
    EXPECT_EQ(outcomes->front().kind, OutcomeKind::kDuplicate);
    EXPECT_EQ(Faults(path_), std::to_string(seq) + "\n");
  }
}

TEST_F(SqliteNames, WhatOtherProgramsDoWithTheFileIsNoReplacement) {
  OpenStore(path_);
  ASSERT_TRUE(Commit(1).ok());
  Shell(path_, "PRAGMA wal_checkpoint(TRUNCATE)");
  ASSERT_TRUE(Commit(2).ok());
  Shell(path_,
        "PRAGMA wal_checkpoint(RESTART); CREATE TABLE theirs (a); DROP TABLE theirs; VACUUM");
  ASSERT_TRUE(Commit(3).ok());
  EXPECT_EQ(Faults(path_), "3\n");
}

/// A database whose WAL is open, as the store's is before its files are noted.
std::unique_ptr<Database> OpenDatabase(const std::string& path) {
  auto database = Database::Open(path, Access::kWrite, milliseconds(1'000));
  EXPECT_TRUE(database.ok() && ConfigureWriter(**database).ok()) << database.status();
  EXPECT_TRUE((*database)->Execute("CREATE TABLE t (a)").ok());
  return *std::move(database);
}

// Between SQLite's opening of a file and the look at its name there is a moment.
TEST_F(SqliteNames, WhatIsReplacedBeforeItIsNotedIsFoundByTheOpenFiles) {
  for (const std::string which : {"", "-wal", "-shm"}) {
    const std::string path = folder_.File(which.empty() ? "db" : which.substr(1));
    const auto lock = FileLock::Take(path);
    ASSERT_TRUE(lock.ok()) << lock.status();
    const auto database = OpenDatabase(path);
    EXPECT_TRUE(NamedFiles::Note(*database).ok()) << NamedFiles::Note(*database).status();
    fs::copy_file(path + which, aside_);
    fs::rename(aside_, path + which);
    const absl::Status status = NamedFiles::Note(*database).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
    EXPECT_THAT(std::string(status.message()), HasSubstr(path + which));
  }
}

// The lock was taken on another file than SQLite opened.
TEST_F(SqliteNames, ADatabaseThatHasTheNameAgainIsNotTakenForTheOneThatIsOpen) {
  const auto lock = FileLock::Take(path_);
  ASSERT_TRUE(lock.ok()) << lock.status();
  fs::rename(path_, aside_);
  const auto database = OpenDatabase(path_);
  fs::rename(aside_, path_);
  EXPECT_FALSE(NamedFiles::Note(*database).ok());
}

}  // namespace
}  // namespace uplink::storage::sqlite
