#include <array>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include "storage/sqlite/file_lock.h"
#include "storage/sqlite/parts.h"
#include "storage/sqlite/reader.h"
#include "storage/sqlite/schema.h"
#include "storage/sqlite/store.h"
#include "tests/support/sqlite_shell.h"
#include "tests/support/temp_folder.h"

namespace uplink::storage::sqlite {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::SqliteShell;
using testing::TempFolder;

class SqliteFiles : public ::testing::Test {
 protected:
  static StoreOptions Options() {
    StoreOptions options;
    options.process = {1};
    return options;
  }
  absl::Status Open(const StoreOptions& options = Options()) const {
    return SqliteStore::Open(path_, options).status();
  }
  /// Makes the file as the store does.
  void Make() const { ASSERT_TRUE(Open().ok()) << Open(); }

  static std::string Text(const absl::Status& status) { return std::string(status.message()); }
  static void ExpectPrecondition(const absl::Status& status) {
    EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition) << status;
  }

  TempFolder folder_;
  const std::string path_ = folder_.File("uplinkd.db");
};

TEST_F(SqliteFiles, SpaceIsWhatTheDiskHasLeftAndPagesOfRowsThatWereDeleted) {
  Make();
  {
    SqliteShell shell(path_);
    shell.Run(
        "CREATE TABLE gone (a); INSERT INTO gone VALUES (zeroblob(8388608)); DROP TABLE gone");
  }
  const auto reader = SqliteReader::Open(path_);
  ASSERT_TRUE(reader.ok()) << reader.status();
  // Others write to the same disk meanwhile.
  std::uint64_t reusable = 0;
  for (int i = 0; i < 1'000 && reusable < 8'388'608; ++i) {
    const auto disk = DiskSpaceOf(path_);
    const auto space = (*reader)->Space();
    ASSERT_TRUE(disk.ok() && space.ok()) << disk.status() << space.status();
    EXPECT_EQ(space->total_bytes, disk->total_bytes);
    reusable = space->free_bytes > disk->free_bytes ? space->free_bytes - disk->free_bytes : 0;
  }
  EXPECT_GE(reusable, 8'388'608U);
}

TEST_F(SqliteFiles, MakesAFileThatIsMarkedAsOursAndPrivate) {
  Make();
  SqliteShell shell(path_);
  EXPECT_EQ(shell.Read("PRAGMA application_id"), std::to_string(kApplicationId) + "\n");
  EXPECT_EQ(shell.Read("PRAGMA user_version"), std::to_string(Migrations().size()) + "\n");
  EXPECT_EQ(shell.Read("PRAGMA journal_mode"), "wal\n");
  EXPECT_EQ(shell.Read("SELECT COUNT(*) FROM schema_migrations"),
            std::to_string(Migrations().size()) + "\n");
  using std::filesystem::perms;
  EXPECT_EQ(std::filesystem::status(path_).permissions() & (perms::group_all | perms::others_all),
            perms::none);
}

TEST_F(SqliteFiles, OpensItsOwnFileAgain) {
  Make();
  EXPECT_TRUE(Open().ok()) << Open();
  StoreOptions options = Options();
  options.migrate = false;
  EXPECT_TRUE(Open(options).ok()) << Open(options);
}

TEST_F(SqliteFiles, RefusesAFileThatANewerStepShutsThisProgramOutOf) {
  Make();
  SqliteShell(path_).Run("INSERT INTO schema_migrations VALUES (99, 99, 'later', 'sum')");
  const absl::Status status = Open();
  EXPECT_TRUE(absl::IsUnimplemented(status)) << status;
  EXPECT_THAT(Text(status),
              AllOf(HasSubstr(path_), HasSubstr("version 99"), HasSubstr("run a newer uplinkd")));
  const absl::Status reader = SqliteReader::Open(path_).status();
  EXPECT_THAT(Text(reader), HasSubstr("version 99"));
}

TEST_F(SqliteFiles, UsesAFileWhoseNewerStepsOnlyAdd) {
  Make();
  SqliteShell(path_).Run("INSERT INTO schema_migrations VALUES (99, 1, 'later', 'sum')");
  EXPECT_TRUE(Open().ok()) << Open();
  EXPECT_TRUE(SqliteReader::Open(path_).ok());
}

TEST_F(SqliteFiles, RefusesAFileOfAnEarlierBuild) {
  Make();
  SqliteShell(path_).Run("ALTER TABLE schema_migrations DROP COLUMN oldest");
  const absl::Status status = Open();
  EXPECT_TRUE(absl::IsUnimplemented(status)) << status;
  EXPECT_THAT(Text(status), AllOf(HasSubstr(path_), HasSubstr("an earlier build")));
}

TEST_F(SqliteFiles, RefusesAFileWhoseStepsAreGone) {
  Make();
  for (const char* const gone : {"DELETE FROM schema_migrations", "DROP TABLE schema_migrations"}) {
    SqliteShell(path_).Run(gone);
    const absl::Status status = Open();
    ExpectPrecondition(status);
    EXPECT_THAT(Text(status),
                AllOf(HasSubstr(path_ + " is damaged: "), HasSubstr("restore it from a backup")));
    EXPECT_THAT(Text(SqliteReader::Open(path_).status()), HasSubstr(" is damaged: "));
  }
}

TEST_F(SqliteFiles, RefusesAnotherProgramsFileAndLeavesItAlone) {
  SqliteShell shell(path_);
  shell.Run("CREATE TABLE theirs (x); PRAGMA application_id = 7");
  const absl::Status status = Open();
  ExpectPrecondition(status);
  EXPECT_THAT(Text(status), AllOf(HasSubstr(path_), HasSubstr("another program")));
  EXPECT_EQ(shell.Read("SELECT name FROM sqlite_schema"), "theirs\n");
  EXPECT_EQ(shell.Read("PRAGMA journal_mode"), "delete\n");
  ExpectPrecondition(SqliteReader::Open(path_).status());
}

TEST_F(SqliteFiles, RefusesAFileWithTablesThoughItBearsNoMark) {
  SqliteShell(path_).Run("CREATE TABLE theirs (x)");
  ExpectPrecondition(Open());
}

TEST_F(SqliteFiles, RefusesWhatIsNoSqliteFile) {
  const std::string text(5000, 'x');
  std::ofstream(path_) << text;
  const absl::Status status = Open();
  ExpectPrecondition(status);
  EXPECT_THAT(Text(status), AllOf(HasSubstr(path_), HasSubstr("no SQLite file")));
  EXPECT_EQ(std::filesystem::file_size(path_), text.size());
}

/// For whom rights count, also where the test runs as root; until it goes.
class WithoutRights final {
 public:
  explicit WithoutRights(const std::vector<std::string>& theirs) {
    if (::geteuid() != 0) return;
    for (const std::string& name : theirs) EXPECT_EQ(::chown(name.c_str(), kNobody, kNobody), 0);
    EXPECT_EQ(::seteuid(kNobody), 0);
    changed_ = true;
  }
  WithoutRights(const WithoutRights&) = delete;
  WithoutRights& operator=(const WithoutRights&) = delete;
  ~WithoutRights() {
    if (!changed_) return;
    EXPECT_EQ(::seteuid(0), 0);
  }

 private:
  static constexpr uid_t kNobody = 65534;
  bool changed_ = false;
};

TEST_F(SqliteFiles, RightsThatAreMissingSayWhatToDo) {
  Make();
  const std::string lock = path_ + ".lock";
  absl::Status taken;
  absl::Status joined;
  absl::Status unread;
  {
    const WithoutRights rights({folder_.File(""), path_, lock});
    std::filesystem::permissions(path_, std::filesystem::perms::none);
    unread = FileLock::Join(path_).status();
    std::filesystem::permissions(lock, std::filesystem::perms::none);
    taken = FileLock::Take(path_).status();
    joined = FileLock::Join(path_).status();
  }
  EXPECT_THAT(Text(unread), HasSubstr("cannot open " + path_ + ": Permission denied; run "));
  for (const absl::Status& status : {taken, joined}) {
    ExpectPrecondition(status);
    EXPECT_THAT(Text(status), AllOf(HasSubstr("cannot open " + lock + ": Permission denied; run "),
                                    HasSubstr("write the store and its folder")));
  }
}

// SQLite cannot make the WAL there, and says so.
TEST_F(SqliteFiles, AFolderThatMayNotBeWrittenIsNoDamage) {
  using std::filesystem::perms;
  const std::string folder = folder_.File("locked");
  std::filesystem::create_directory(folder);
  const std::string path = folder + "/uplinkd.db";
  ASSERT_TRUE(SqliteStore::Open(path, Options()).ok());
  for (const bool marked : {false, true}) {
    const std::string mark = path + ".damaged";
    if (marked) std::ofstream(mark).close();
    absl::Status status;
    {
      const WithoutRights rights({folder_.File(""), folder, path, path + ".lock"});
      std::filesystem::permissions(folder, perms::owner_read | perms::owner_exec);
      status = SqliteStore::Open(path, Options()).status();
      std::filesystem::permissions(folder, perms::owner_all);
    }
    EXPECT_FALSE(status.ok());
    EXPECT_THAT(Text(status), AllOf(HasSubstr(path), HasSubstr("readonly database (1544)"),
                                    Not(HasSubstr("damaged"))));
    EXPECT_EQ(std::filesystem::exists(mark), marked) << "no damage was found";
  }
  EXPECT_TRUE(SqliteStore::Open(path, Options()).ok());
}

TEST_F(SqliteFiles, RefusesAFileThatWasMigratedOtherwise) {
  Make();
  SqliteShell(path_).Run("UPDATE schema_migrations SET sha256 = 'other' WHERE version = 1");
  const absl::Status status = Open();
  EXPECT_TRUE(absl::IsUnimplemented(status)) << status;
  EXPECT_THAT(Text(status), AllOf(HasSubstr(path_), HasSubstr(Migrations().front().name)));
}

TEST_F(SqliteFiles, RefusesAnOlderFileIfItMayNotMigrate) {
  StoreOptions options = Options();
  options.migrate = false;
  const absl::Status status = Open(options);
  ExpectPrecondition(status);
  EXPECT_THAT(Text(status),
              AllOf(HasSubstr(path_), HasSubstr("version 0"), HasSubstr("store.migrate")));
  EXPECT_TRUE(Open().ok()) << Open();
}

TEST_F(SqliteFiles, KeepsNothingOfAMigrationThatFails) {
  Make();
  const std::int64_t next = static_cast<std::int64_t>(Migrations().size()) + 1;
  {
    auto database = Database::Open(path_, Access::kWrite, milliseconds(100));
    ASSERT_TRUE(database.ok()) << database.status();
    std::vector<Migration> migrations(Migrations().begin(), Migrations().end());
    migrations.push_back({next, next, "broken", "sum", "CREATE TABLE t (x); nonsense;"});
    const absl::Status status = Migrate(**database, migrations, IfOlder::kMigrate);
    EXPECT_FALSE(status.ok());
    EXPECT_THAT(Text(status), AllOf(HasSubstr(path_), HasSubstr("broken")));
    EXPECT_EQ(*(*database)->ReadInt("PRAGMA user_version"), next - 1);
    EXPECT_EQ(*(*database)->ReadInt("SELECT COUNT(*) FROM sqlite_schema WHERE name = 't'"), 0);

    migrations.back() = {next, next, "good", "sum", "CREATE TABLE t (x);"};
    EXPECT_TRUE(Migrate(**database, migrations, IfOlder::kMigrate).ok());
    EXPECT_EQ(*(*database)->ReadInt("PRAGMA user_version"), next);
  }
  EXPECT_THAT(Text(Open()), HasSubstr(fmt::format("version {}", next)));
}

TEST_F(SqliteFiles, ReadsBackThatEveryCommitIsSynced) {
  auto database = Database::Open(path_, Access::kWrite, milliseconds(100));
  ASSERT_TRUE(database.ok()) << database.status();
  EXPECT_TRUE((*database)->Execute("PRAGMA synchronous = OFF").ok());
  EXPECT_TRUE(ConfigureWriter(**database).ok());
  EXPECT_EQ(*(*database)->ReadInt("PRAGMA synchronous"), 2);
  EXPECT_EQ(*(*database)->ReadText("PRAGMA journal_mode"), "wal");
}

TEST_F(SqliteFiles, RefusesADatabaseThatDoesNotTakeAWal) {
  auto database = Database::Open(path_, Access::kWrite, milliseconds(100));
  ASSERT_TRUE(database.ok()) << database.status();
  SqliteShell reader(path_);
  reader.Run("CREATE TABLE t (x); BEGIN; SELECT * FROM t");  // a lock against the change of mode
  EXPECT_FALSE(ConfigureWriter(**database).ok());
}

TEST_F(SqliteFiles, NamesThePathIfTheFolderIsMissing) {
  const std::string path = folder_.File("no/such/folder/uplinkd.db");
  const absl::Status status = SqliteStore::Open(path, Options()).status();
  ExpectPrecondition(status);
  EXPECT_THAT(Text(status), AllOf(HasSubstr(path), HasSubstr("No such file")));
}

TEST_F(SqliteFiles, NamesThePathIfItCannotBeWritten) {
  std::filesystem::create_directory(path_);
  StoreOptions options = Options();
  const absl::Status status = Open(options);
  ExpectPrecondition(status);
  EXPECT_THAT(Text(status), AllOf(HasSubstr(path_), HasSubstr("directory")));
  std::filesystem::create_directory(folder_.File("other.db.lock"));
  const absl::Status no_lock = SqliteStore::Open(folder_.File("other.db"), options).status();
  EXPECT_THAT(Text(no_lock), HasSubstr("other.db.lock"));
  EXPECT_FALSE(IsInUse(no_lock)) << "no process has it";
}

TEST_F(SqliteFiles, KeepsASecondWriterAwayUntilTheFirstIsGone) {
  auto first = SqliteStore::Open(path_, Options());
  ASSERT_TRUE(first.ok()) << first.status();
  const absl::Status second = Open();
  ExpectPrecondition(second);
  EXPECT_THAT(Text(second), AllOf(HasSubstr(path_), HasSubstr("in use")));
  EXPECT_TRUE(IsInUse(second));
  EXPECT_TRUE(SqliteReader::Open(path_).ok()) << "a reader is no writer";
  first->reset();
  EXPECT_TRUE(Open().ok()) << Open();
}

TEST_F(SqliteFiles, WhoLooksAtTheLockForAnInstantKeepsNobodyAway) {
  Make();
  const std::string name = path_ + ".lock";
  const int looks = ::open(name.c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_GE(looks, 0);
  ASSERT_EQ(::flock(looks, LOCK_SH | LOCK_NB), 0);
  const int opens = ::inotify_init1(IN_CLOEXEC);
  ASSERT_GE(::inotify_add_watch(opens, name.c_str(), IN_OPEN), 0);
  std::future<absl::Status> taken =
      std::async(std::launch::async, [this] { return FileLock::Take(path_).status(); });
  // Until it has opened the lock file, and is about to lock it.
  std::array<char, 512> events{};
  ASSERT_GT(::read(opens, events.data(), events.size()), 0);
  ASSERT_EQ(::flock(looks, LOCK_UN), 0);
  EXPECT_TRUE(taken.get().ok());
  ::close(looks);
  ::close(opens);
}

/// Whether a second writer is kept away that comes by another name, and let in after the first.
class SqliteOtherNames : public SqliteFiles {
 protected:
  void ExpectOneWriter(const std::string& first_name, const std::string& second_name) {
    auto first = SqliteStore::Open(first_name, Options());
    ASSERT_TRUE(first.ok()) << first.status();
    const absl::Status second = SqliteStore::Open(second_name, Options()).status();
    ExpectPrecondition(second);
    EXPECT_THAT(Text(second), AllOf(HasSubstr(second_name), HasSubstr("in use")));
    EXPECT_TRUE(IsInUse(second));
    first->reset();
    const absl::Status after = SqliteStore::Open(second_name, Options()).status();
    EXPECT_TRUE(after.ok()) << after;
  }
  const std::string other_ = folder_.File("other.db");
};

TEST_F(SqliteOtherNames, OfALinkAndItsFile) {
  Make();
  std::filesystem::create_symlink(path_, other_);
  ExpectOneWriter(path_, other_);
  ExpectOneWriter(other_, path_);
}

TEST_F(SqliteOtherNames, OfTwoLinksToAFileThatIsNotThereYet) {
  std::filesystem::create_symlink(path_, other_);
  std::filesystem::create_symlink(path_, folder_.File("third.db"));
  ExpectOneWriter(other_, folder_.File("third.db"));
}

TEST_F(SqliteOtherNames, OfALinkToTheFolder) {
  std::filesystem::create_directory(folder_.File("data"));
  std::filesystem::create_directory_symlink(folder_.File("data"), folder_.File("link"));
  ExpectOneWriter(folder_.File("data/uplinkd.db"), folder_.File("link/uplinkd.db"));
}

TEST_F(SqliteOtherNames, OfARelativePath) {
  Make();
  ExpectOneWriter(path_, std::filesystem::relative(path_).string());
}

TEST_F(SqliteOtherNames, OfAHardLink) {
  Make();
  const auto first = SqliteStore::Open(path_, Options());
  ASSERT_TRUE(first.ok()) << first.status();
  std::filesystem::create_hard_link(path_, other_);
  EXPECT_THAT(Text(SqliteStore::Open(other_, Options()).status()),
              AllOf(HasSubstr(other_), HasSubstr("in use")));
}

// The newest rows lie beside the name by which the file was opened last.
TEST_F(SqliteOtherNames, AFileWithHardLinksIsRefusedByEachOfThem) {
  Make();
  std::filesystem::create_hard_link(path_, other_);
  for (const std::string& name : {path_, other_}) {
    for (const absl::Status& refused :
         {SqliteStore::Open(name, Options()).status(), OpenClockMarks(name).status(),
          OpenForgetStore(name).status()}) {
      ExpectPrecondition(refused);
      EXPECT_THAT(Text(refused), AllOf(HasSubstr(name), HasSubstr("2 names (hard links)"),
                                       HasSubstr("remove the others")));
    }
    EXPECT_FALSE(std::filesystem::exists(name + "-wal")) << "it was opened";
  }
  std::filesystem::remove(other_);
  EXPECT_TRUE(Open().ok()) << Open();
}

// As through a mount of the file alone, beside which there is another WAL.
TEST_F(SqliteOtherNames, WhoWritesBesideAServerMustHaveItsName) {
  Make();
  const auto server = FileLock::Take(path_);
  ASSERT_TRUE(server.ok()) << server.status();
  EXPECT_TRUE(OpenClockMarks(path_).ok()) << OpenClockMarks(path_).status();
  EXPECT_TRUE(OpenForgetStore(path_).ok()) << OpenForgetStore(path_).status();
  std::filesystem::create_symlink(path_, folder_.File("link.db"));
  EXPECT_TRUE(OpenClockMarks(folder_.File("link.db")).ok()) << "SQLite follows links";

  std::filesystem::rename(path_, other_);
  for (const absl::Status& refused :
       {OpenClockMarks(other_).status(), OpenForgetStore(other_).status()}) {
    ExpectPrecondition(refused);
    EXPECT_THAT(Text(refused),
                AllOf(HasSubstr(other_), HasSubstr("another name"), HasSubstr("store.url")));
  }
}

TEST_F(SqliteOtherNames, WithoutAServerTheNameIsFreeAndNothingIsMade) {
  Make();
  std::filesystem::remove(path_ + ".lock");
  EXPECT_TRUE(OpenClockMarks(path_).ok()) << OpenClockMarks(path_).status();
  EXPECT_FALSE(std::filesystem::exists(path_ + ".lock"));
}

TEST_F(SqliteOtherNames, OfAnotherFileInTheSamePlace) {
  auto first = SqliteStore::Open(path_, Options());
  ASSERT_TRUE(first.ok()) << first.status();
  std::filesystem::rename(path_, other_);
  EXPECT_THAT(Text(Open()), HasSubstr("in use"));
  std::ofstream(path_).put('x');
  EXPECT_THAT(Text(Open()), HasSubstr("in use"));
  EXPECT_THAT(Text(SqliteStore::Open(other_, Options()).status()), HasSubstr("in use"));
}

// A program before this one locks `<path>.lock` alone, by the path that it was given.
TEST_F(SqliteOtherNames, OfAnEarlierProgram) {
  Make();
  std::filesystem::create_symlink(path_, other_);
  const int held = ::open((path_ + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(::flock(held, LOCK_EX | LOCK_NB), 0);
  EXPECT_THAT(Text(Open()), HasSubstr("in use"));
  EXPECT_THAT(Text(SqliteStore::Open(other_, Options()).status()), HasSubstr("in use"));
  ::close(held);
  const auto first = SqliteStore::Open(other_, Options());
  ASSERT_TRUE(first.ok()) << first.status();
  for (const std::string& name : {path_, other_}) {
    const int wanted = ::open((name + ".lock").c_str(), O_RDWR | O_CLOEXEC);
    EXPECT_NE(::flock(wanted, LOCK_EX | LOCK_NB), 0) << name;
    ::close(wanted);
  }
}

// Or a server that is not root could not open what uplinkctl left as root.
TEST_F(SqliteFiles, WhatRootMakesBesideAFileIsTheOwnersOfTheFile) {
  Make();
  const std::pair self(::geteuid(), ::getegid());
  // Only root can give files away; everybody else keeps them.
  const std::pair owner = self.first == 0 ? std::pair(uid_t{4711}, gid_t{4712}) : self;
  const std::string link = folder_.File("link.db");
  std::filesystem::create_symlink(path_, link);
  ASSERT_EQ(::chown(path_.c_str(), owner.first, owner.second), 0);
  const auto owners = [](const std::string& name) {
    struct stat status {};
    EXPECT_EQ(::stat(name.c_str(), &status), 0) << name;
    return std::pair(status.st_uid, status.st_gid);
  };
  EXPECT_TRUE(FileLock::Take(link).ok());
  EXPECT_EQ(owners(link + ".lock"), owner);
  EXPECT_EQ(owners(path_ + ".lock"), self) << "it was there";
  std::filesystem::remove(path_ + ".lock");
  EXPECT_TRUE(FileLock::Take(path_).ok());
  EXPECT_EQ(owners(path_ + ".lock"), owner);
}

TEST_F(SqliteFiles, RefusesAReaderWithoutAFile) {
  const absl::Status status = SqliteReader::Open(path_).status();
  ExpectPrecondition(status);
  EXPECT_THAT(Text(status), HasSubstr(path_));
  EXPECT_FALSE(std::filesystem::exists(path_));
}

}  // namespace
}  // namespace uplink::storage::sqlite
