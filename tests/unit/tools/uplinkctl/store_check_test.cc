#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "storage/sqlite/file_lock.h"
#include "storage/sqlite/schema.h"
#include "tests/support/temp_folder.h"
#include "tools/uplinkctl/doctor/disk_check.h"
#include "tools/uplinkctl/doctor/postgres_check.h"
#include "tools/uplinkctl/doctor/server_check.h"
#include "tools/uplinkctl/doctor/sqlite_check.h"

namespace uplink::ctl {
namespace {

using storage::postgres::StoreState;
using ::testing::HasSubstr;

Finding Worst(const Findings& findings) {
  return *std::max_element(
      findings.begin(), findings.end(),
      [](const Finding& a, const Finding& b) { return a.severity < b.severity; });
}

StoreState Database() {
  StoreState state;
  state.where = "db:5432/uplinkd";
  state.schema_version = 7;
  state.schema_needed = 7;
  state.synchronous_commit = "on";
  return state;
}

Finding OfDatabase(const StoreState& state, const config::StoreConfig& store = {}) {
  return Worst(PostgresFindings(state, store));
}

TEST(PostgresCheck, AGoodDatabaseIsGood) {
  EXPECT_EQ(OfDatabase(Database()).severity, Severity::kOk);
}

TEST(PostgresCheck, ADeadOneIsAnErrorWithItsReason) {
  const Finding finding =
      Worst(PostgresFindings(absl::UnavailableError("db:5432: no answer within 3 s"), {}));
  EXPECT_EQ(finding.severity, Severity::kError);
  EXPECT_EQ(finding.what, "db:5432: no answer within 3 s");
  EXPECT_THAT(finding.remedy, HasSubstr("start the database"));
}

TEST(PostgresCheck, AMissingStepIsAnErrorUnlessTheServerMayApplyIt) {
  StoreState state = Database();
  state.schema_version = 6;
  state.steps_missing = 1;
  config::StoreConfig store;
  store.migrate = false;
  EXPECT_EQ(OfDatabase(state, store).severity, Severity::kError);
  EXPECT_THAT(OfDatabase(state, store).what, HasSubstr("has schema 6, and this program needs 7"));
  EXPECT_THAT(OfDatabase(state, store).remedy, HasSubstr("uplinkctl store migrate"));
  store.migrate = true;
  EXPECT_EQ(OfDatabase(state, store).severity, Severity::kOk);
}

TEST(PostgresCheck, ASchemaThatShutsTheProgramOutIsAnError) {
  StoreState state = Database();
  state.schema_fits = absl::UnimplementedError("run a newer uplinkd");
  EXPECT_EQ(OfDatabase(state).severity, Severity::kError);
}

TEST(PostgresCheck, WhatTakesNoWritesIsAnError) {
  StoreState state = Database();
  state.standby = true;
  EXPECT_THAT(OfDatabase(state).what, HasSubstr("is a standby"));
  state = Database();
  state.read_only = true;
  EXPECT_THAT(OfDatabase(state).what, HasSubstr("is read-only"));
  state = Database();
  state.tables_denied = 3;
  EXPECT_THAT(OfDatabase(state).what, HasSubstr("may not write 3 tables"));
  state = Database();
  state.utf8 = false;
  EXPECT_THAT(OfDatabase(state).what, HasSubstr("UTF8"));
}

TEST(PostgresCheck, LostDurabilityIsNamed) {
  StoreState state = Database();
  state.fsync = false;
  EXPECT_EQ(OfDatabase(state).severity, Severity::kError);
  config::StoreConfig accepts;
  accepts.accept_unsafe = true;
  EXPECT_EQ(OfDatabase(state, accepts).severity, Severity::kWarning);
  state = Database();
  state.full_page_writes = false;
  EXPECT_EQ(OfDatabase(state).severity, Severity::kWarning);
  state = Database();
  // Each transaction of uplinkd sets it.
  state.synchronous_commit = "off";
  EXPECT_EQ(OfDatabase(state).severity, Severity::kOk);
}

TEST(PostgresCheck, ClocksApartAreAWarning) {
  StoreState state = Database();
  state.clock_offset = -kDatabaseClockApartMax;
  EXPECT_EQ(OfDatabase(state).severity, Severity::kOk);
  state.clock_offset -= milliseconds(1);
  EXPECT_EQ(OfDatabase(state).severity, Severity::kWarning);
  EXPECT_EQ(OfDatabase(state).what, "the database's clock is 5001 ms behind this machine's");
}

constexpr std::int64_t kNeeded = 7;

SqliteFacts File() {
  SqliteFacts facts;
  facts.path = "/s/u.db";
  facts.folder = "/s";
  facts.files = {{"/s/u.db", 0}};
  facts.links = 1;
  facts.place = StorePlace::kFile;
  facts.header = SqliteHeader{true, storage::sqlite::kApplicationId, kNeeded};
  return facts;
}

Finding OfFile(const SqliteFacts& facts, const config::StoreConfig& store = {}) {
  return Worst(SqliteFindings(facts, store, kNeeded, "uplinkd"));
}

TEST(SqliteCheck, AGoodFileAndNoFileAreGood) {
  EXPECT_EQ(OfFile(File()).severity, Severity::kOk);
  SqliteFacts none = File();
  none.header.reset();
  EXPECT_EQ(OfFile(none), Ok("store.url", "/s/u.db is empty: the server makes its tables"));
  none.files.clear();
  none.place = StorePlace::kNothing;
  none.links = 0;
  EXPECT_THAT(OfFile(none).what, HasSubstr("is not there yet"));
  EXPECT_EQ(OfFile(none).severity, Severity::kOk);
}

TEST(SqliteCheck, AServerThatMayNotMigrateMakesNoTables) {
  config::StoreConfig store;
  store.migrate = false;
  SqliteFacts facts = File();
  facts.header.reset();
  EXPECT_EQ(OfFile(facts, store), Error("store.url", "/s/u.db is empty, and store.migrate is false",
                                        "start the server once with store.migrate = true"));
  facts.files.clear();
  facts.place = StorePlace::kNothing;
  EXPECT_EQ(OfFile(facts, store).what, "/s/u.db is not there yet, and store.migrate is false");
}

TEST(SqliteCheck, WhatTheUserMayNotWriteIsNamed) {
  SqliteFacts facts = File();
  facts.files.push_back({"/s/u.db-wal", EACCES});
  EXPECT_EQ(OfFile(facts),
            Error("store.url", "uplinkd may not write /s/u.db-wal: Permission denied",
                  "run chown uplinkd /s/u.db-wal"));
  facts = File();
  facts.folder_error = EROFS;
  EXPECT_THAT(OfFile(facts).what, HasSubstr("may not write the folder /s: Read-only file system"));
}

TEST(SqliteCheck, AFileThatCannotBeReadIsNotCalledMissing) {
  SqliteFacts facts = File();
  facts.files.front().access_error = EACCES;
  facts.header.reset();
  EXPECT_EQ(SqliteFindings(facts, {}, kNeeded, "uplinkd").size(), 1U);
}

TEST(SqliteCheck, AnotherProgramsFileIsAnError) {
  SqliteFacts facts = File();
  facts.header->application_id = 1;
  EXPECT_THAT(OfFile(facts).what, HasSubstr("is not a store of uplinkd"));
  facts.header->is_sqlite = false;
  EXPECT_THAT(OfFile(facts).what, HasSubstr("is not a store of uplinkd"));
}

TEST(SqliteCheck, TheSchemaIsHeldAgainstTheProgram) {
  SqliteFacts facts = File();
  config::StoreConfig store;
  facts.header->schema_version = kNeeded - 1;
  EXPECT_EQ(OfFile(facts, store).severity, Severity::kOk);
  store.migrate = false;
  EXPECT_EQ(OfFile(facts, store).severity, Severity::kError);
  facts.header->schema_version = kNeeded + 1;
  EXPECT_EQ(OfFile(facts, store).severity, Severity::kWarning);
}

TEST(SqliteCheck, ASchemaThatIsStillInTheWalIsGood) {
  SqliteFacts facts = File();
  facts.header = SqliteHeader{.is_sqlite = true};
  EXPECT_THAT(OfFile(facts).what, HasSubstr("is not a store of uplinkd"));
  facts.wal_filled = true;
  EXPECT_EQ(OfFile(facts), Ok("store.url",
                              "/s/u.db: its schema is still in the -wal; the server reads it when "
                              "it starts"));
  // Another program's, which has tables.
  facts.header->changes_of_tables = 1;
  EXPECT_THAT(OfFile(facts).what, HasSubstr("is not a store of uplinkd"));
}

TEST(SqliteCheck, WhatIsNoFileIsAnError) {
  SqliteFacts facts;
  facts.path = "/s/u.db";
  facts.place = StorePlace::kLoop;
  EXPECT_EQ(OfFile(facts).what, "/s/u.db is a link that leads to itself");
  facts.place = StorePlace::kNoFile;
  EXPECT_EQ(OfFile(facts), Error("store.url", "/s/u.db is no regular file", "name a file"));
}

TEST(SqliteCheck, ALinkToNothingIsGoodWhereTheServerCanMakeTheFile) {
  SqliteFacts facts;
  facts.path = "/s/u.db";
  facts.target = "/t/u.db";
  facts.folder = "/t";
  EXPECT_EQ(OfFile(facts), Ok("store.url", "/t/u.db is not there yet: the server makes it"));
  facts.folder_error = ENOENT;
  EXPECT_EQ(OfFile(facts).what, "/s/u.db is a link to /t/u.db, whose folder is missing");
  EXPECT_EQ(OfFile(facts).severity, Severity::kError);
}

TEST(SqliteCheck, AStoreThatAnotherServerHoldsIsAnError) {
  SqliteFacts facts = File();
  EXPECT_TRUE(HolderFindings(facts, StoreHolder::kOther).empty());
  facts.held = true;
  EXPECT_TRUE(HolderFindings(facts, StoreHolder::kOwnServer).empty());
  const Finding other = Worst(HolderFindings(facts, StoreHolder::kOther));
  EXPECT_EQ(other.severity, Severity::kError);
  EXPECT_THAT(other.what, HasSubstr("/s/u.db is in use by another process"));
  EXPECT_EQ(Worst(HolderFindings(facts, StoreHolder::kUnknown)).severity, Severity::kWarning);
}

TEST(SqliteCheck, WhatWouldLoseRowsIsAnError) {
  SqliteFacts facts = File();
  facts.damaged = true;
  EXPECT_EQ(OfFile(facts).severity, Severity::kError);
  facts = File();
  facts.links = 2;
  EXPECT_THAT(OfFile(facts).what, HasSubstr("2 names"));
  facts = File();
  facts.header.reset();
  facts.wal_filled = true;
  EXPECT_THAT(OfFile(facts).remedy, HasSubstr("do not start the server"));
}

TEST(SqliteFactsOf, AHeaderIsReadByItsPlaces) {
  std::string bytes("SQLite format 3\0", 16);
  bytes.resize(kSqliteHeaderBytes, '\0');
  bytes[43] = 5;
  bytes[63] = 7;
  bytes.replace(68, 4, "UPLK");
  const SqliteHeader header = ParseHeader(bytes);
  EXPECT_TRUE(header.is_sqlite);
  EXPECT_EQ(header.changes_of_tables, 5);
  EXPECT_EQ(header.schema_version, 7);
  EXPECT_EQ(header.application_id, storage::sqlite::kApplicationId);
  bytes.pop_back();
  EXPECT_FALSE(ParseHeader(bytes).is_sqlite);
  EXPECT_FALSE(ParseHeader("").is_sqlite);
}

TEST(SqliteFactsOf, AFolderIsLookedAtAndLeftAsItIs) {
  const testing::TempFolder folder;
  const SqliteFacts none = ReadSqliteFacts(folder.File("u.db"));
  EXPECT_TRUE(none.files.empty());
  EXPECT_EQ(none.folder_error, 0);
  EXPECT_TRUE(none.space.has_value());
  std::ofstream(folder.File("u.db-wal")) << "rows";
  EXPECT_TRUE(ReadSqliteFacts(folder.File("u.db")).wal_filled);
  EXPECT_EQ(ReadSqliteFacts(folder.File("no/u.db")).folder_error, ENOENT);
  EXPECT_FALSE(std::filesystem::exists(folder.File("u.db")));
}

TEST(SqliteFactsOf, AnEmptyFileHasNoHeader) {
  const testing::TempFolder folder;
  std::ofstream(folder.File("u.db")).close();
  const SqliteFacts facts = ReadSqliteFacts(folder.File("u.db"));
  EXPECT_EQ(facts.place, StorePlace::kFile);
  EXPECT_FALSE(facts.header.has_value());
}

TEST(SqliteFactsOf, LinksAndPipesAreTold) {
  const testing::TempFolder folder;
  const auto link = [&](const char* to, const char* name) {
    std::filesystem::create_symlink(to, folder.File(name));
    return ReadSqliteFacts(folder.File(name));
  };
  EXPECT_EQ(link("self.db", "self.db").place, StorePlace::kLoop);
  const SqliteFacts dangling = link("b.db", "a.db");
  EXPECT_EQ(dangling.place, StorePlace::kNothing);
  EXPECT_EQ(dangling.target, folder.File("b.db"));
  EXPECT_EQ(dangling.folder_error, 0);
  EXPECT_EQ(link("a.db", "twice.db").target, folder.File("b.db"));
  EXPECT_EQ(link("no/b.db", "lost.db").folder_error, ENOENT);
  EXPECT_EQ(link("/dev/null", "null.db").place, StorePlace::kNoFile);
  ASSERT_EQ(::mkfifo(folder.File("pipe.db").c_str(), 0600), 0);
  EXPECT_EQ(ReadSqliteFacts(folder.File("pipe.db")).place, StorePlace::kNoFile);
}

TEST(SqliteFactsOf, TheLocksAreAskedAndNotMade) {
  const testing::TempFolder folder;
  const std::string path = folder.File("u.db");
  EXPECT_FALSE(ReadSqliteFacts(path).held);
  EXPECT_FALSE(std::filesystem::exists(path + ".lock"));
  {
    const auto lock = storage::sqlite::FileLock::Take(path);
    ASSERT_TRUE(lock.ok());
    EXPECT_TRUE(ReadSqliteFacts(path).held);
    // By another name that leads to it.
    std::filesystem::create_symlink("u.db", folder.File("link.db"));
    EXPECT_TRUE(ReadSqliteFacts(folder.File("link.db")).held);
    std::filesystem::remove(path + ".lock");
    EXPECT_TRUE(ReadSqliteFacts(path).held);
  }
  EXPECT_FALSE(ReadSqliteFacts(path).held);
}

TEST(DiskCheck, TheBoundsAreTheServers) {
  constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
  const auto finding = [](std::uint64_t free) {
    return DiskFinding("/s", {.free_bytes = free, .total_bytes = 1'000'000 * kMiB}, 100 * kMiB);
  };
  EXPECT_EQ(finding(100 * kMiB).severity, Severity::kOk);
  EXPECT_EQ(finding(100 * kMiB - 1).severity, Severity::kWarning);
  EXPECT_EQ(finding(50 * kMiB).severity, Severity::kWarning);
  EXPECT_EQ(finding(50 * kMiB - 1).severity, Severity::kError);
}

TEST(ServerCheck, TheRunningServersWordsAreJudged) {
  const auto finding = [](unsigned status, const char* body) {
    return ServerFinding(link::HttpAnswer{status, body});
  };
  EXPECT_EQ(finding(200, R"({"degraded":[]})").severity, Severity::kOk);
  EXPECT_EQ(finding(200, R"({"degraded":["clock"]})").severity, Severity::kWarning);
  EXPECT_EQ(finding(503, R"({"refuses":["draining"]})").severity, Severity::kError);
  EXPECT_EQ(finding(200, "<html>").severity, Severity::kError);
  EXPECT_EQ(ServerFinding(absl::UnavailableError("connect: refused")).severity, Severity::kError);
}

}  // namespace
}  // namespace uplink::ctl
