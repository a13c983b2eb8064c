#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "storage/postgres/reader.h"
#include "storage/postgres/store.h"
#include "tests/support/manual_clock.h"
#include "tests/support/postgres_database.h"
#include "tests/support/temp_folder.h"

namespace uplink::storage::postgres {
namespace {

using testing::DatabaseContent;
using testing::PostgresDatabase;
using testing::PostgresShell;

class PostgresLinkTest : public ::testing::Test {
 protected:
  absl::StatusOr<std::unique_ptr<PostgresStore>> Open(const std::string& url,
                                                      const std::string& password_file = "") {
    options_.url = url;
    options_.password_file = password_file;
    return PostgresStore::Open(options_, clock_);
  }
  std::string PasswordFile(const std::string& password) {
    std::string path = folder_.File("password");
    std::ofstream(path) << password << "\n";
    return path;
  }
  static bool Says(const absl::Status& status, absl::string_view text) {
    return status.message().find(text) != absl::string_view::npos;
  }

  StoreOptions options_;
  const SystemClock clock_{};
  testing::TempFolder folder_;
};

TEST_F(PostgresLinkTest, AFitDatabaseOpens) {
  PostgresDatabase database;
  const auto store = Open(database.url());
  ASSERT_TRUE(store.ok()) << store.status();
  EXPECT_TRUE((*store)->open_error().ok());
  EXPECT_FALSE((*store)->facts().unsafe);
}

TEST_F(PostgresLinkTest, AnUnreachableServerIsNoErrorYet) {
  const auto store = Open("postgresql://uplinkd@127.0.0.1:1/x");
  ASSERT_TRUE(store.ok()) << store.status();
  EXPECT_TRUE(absl::IsUnavailable((*store)->open_error())) << (*store)->open_error();
  EXPECT_TRUE(Says((*store)->open_error(), "127.0.0.1:1/x")) << (*store)->open_error();
  const auto swept = (*store)->Sweep(SystemTime());
  EXPECT_TRUE(absl::IsUnavailable(swept.status())) << swept.status();
}

TEST_F(PostgresLinkTest, APasswordComesFromItsFile) {
  PostgresDatabase database;
  const std::string url = database.cluster().TcpUrl("uplinkd", database.name());
  const auto store = Open(url, PasswordFile("uplinkd"));
  ASSERT_TRUE(store.ok()) << store.status();
  EXPECT_TRUE((*store)->open_error().ok()) << (*store)->open_error();
}

TEST_F(PostgresLinkTest, APipeWithThePasswordIsNotWaitedFor) {
  const std::string pipe = folder_.File("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const auto store = Open("postgresql://uplinkd@127.0.0.1:1/x", pipe);
  const absl::Status why = store.ok() ? (*store)->open_error() : store.status();
  EXPECT_TRUE(Says(why, "store.password_file " + pipe + " is not a regular file")) << why;
}

TEST_F(PostgresLinkTest, AFileThatIsNoPasswordIsNotReadWhole) {
  const std::string file = PasswordFile(std::string(std::size_t{2} * 1024 * 1024, 'x'));
  const auto store = Open("postgresql://uplinkd@127.0.0.1:1/x", file);
  const absl::Status why = store.ok() ? (*store)->open_error() : store.status();
  EXPECT_TRUE(Says(why, "store.password_file " + file + " is larger than 1048576 bytes")) << why;
}

TEST_F(PostgresLinkTest, AWrongPasswordIsAnError) {
  PostgresDatabase database;
  const std::string url = database.cluster().TcpUrl("uplinkd", database.name());
  const absl::Status wrong = Open(url, PasswordFile("wrong")).status();
  EXPECT_TRUE(absl::IsInternal(wrong)) << wrong;
  EXPECT_TRUE(Says(wrong, "password authentication failed")) << wrong;
  EXPECT_TRUE(Says(wrong, "(28P01); correct the password file")) << wrong;
}

TEST_F(PostgresLinkTest, AMissingDatabaseIsAnError) {
  PostgresDatabase database;
  const std::string url = database.cluster().TcpUrl("uplinkd", "no_such_database");
  const absl::Status missing = Open(url, PasswordFile("uplinkd")).status();
  EXPECT_TRUE(absl::IsInternal(missing)) << missing;
  EXPECT_TRUE(Says(missing, "(3D000); create the database")) << missing;
}

TEST_F(PostgresLinkTest, AMissingPasswordFileIsNamed) {
  const std::string path = folder_.File("none");
  const absl::Status missing = Open("postgresql://uplinkd@127.0.0.1:1/x", path).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(missing)) << missing;
  EXPECT_TRUE(Says(missing, path)) << missing;
}

TEST_F(PostgresLinkTest, AnUnknownDatabaseIsAnError) {
  const auto cluster = testing::PostgresCluster::FromEnvironment();
  const absl::Status unknown = Open(cluster.Url("uplinkd", "no_such_database")).status();
  EXPECT_TRUE(absl::IsInternal(unknown)) << unknown;
  EXPECT_TRUE(Says(unknown, "no_such_database")) << unknown;
}

TEST_F(PostgresLinkTest, ADatabaseWithoutOurSchemaIsAnError) {
  PostgresDatabase database(DatabaseContent::kEmpty);
  const absl::Status old = Open(database.url()).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(old)) << old;
  EXPECT_TRUE(Says(old, "uplinkctl store migrate")) << old;
}

TEST_F(PostgresLinkTest, MigratesIfItMay) {
  PostgresDatabase database(DatabaseContent::kEmpty);
  options_.migrate = true;
  EXPECT_TRUE(Open(database.owner_url()).ok());
}

TEST_F(PostgresLinkTest, MigratesWheneverTheServerComes) {
  testing::PostgresDatabase database(DatabaseContent::kEmpty);
  options_.migrate = true;
  options_.connect_now = false;
  const auto store = Open(database.owner_url());
  ASSERT_TRUE(store.ok()) << store.status();
  EXPECT_TRUE((*store)->Sweep(SystemTime()).ok());
}

TEST_F(PostgresLinkTest, ADatabaseOfAnotherEncodingIsAnError) {
  testing::PostgresDatabase database(DatabaseContent::kEmpty);
  const std::string other = database.name() + "_latin";
  PostgresShell shell(database.cluster().Url("postgres", "postgres"));
  shell.Run("CREATE DATABASE " + other +
            " TEMPLATE template0 ENCODING 'LATIN1' LC_COLLATE 'C' LC_CTYPE 'C'");
  const absl::Status latin = Open(database.cluster().Url("uplinkd", other)).status();
  shell.Run("DROP DATABASE " + other);
  EXPECT_TRUE(absl::IsFailedPrecondition(latin)) << latin;
  EXPECT_TRUE(Says(latin, "UTF8")) << latin;
}

TEST_F(PostgresLinkTest, OfTwoPlacesTheOneThatTakesWritesIsUsed) {
  testing::PostgresDatabase database;
  // The first place refuses; both are one server here.
  const auto& cluster = database.cluster();
  const std::string url = "postgresql://uplinkd@/" + database.name() + "?host=/nowhere," +
                          cluster.folder + "&port=" + cluster.port;
  const auto store = Open(url);
  ASSERT_TRUE(store.ok()) << store.status();
  EXPECT_TRUE((*store)->open_error().ok()) << (*store)->open_error();
}

TEST_F(PostgresLinkTest, AReadOnlyDatabaseIsAnError) {
  PostgresDatabase database;
  database.Shell().Run("ALTER DATABASE " + database.name() +
                       " SET default_transaction_read_only = on");
  const absl::Status read_only = Open(database.url()).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(read_only)) << read_only;
  EXPECT_TRUE(Says(read_only, "read-only")) << read_only;
}

TEST_F(PostgresLinkTest, TheServersClockIsComparedWithOurs) {
  PostgresDatabase database;
  const testing::ManualClock clock(FromUnixMs(UnixMs(clock_.System()) - 60'000));
  options_.url = database.url();
  const auto store = PostgresStore::Open(options_, clock);
  ASSERT_TRUE(store.ok()) << store.status();
  EXPECT_GE((*store)->facts().clock_offset, milliseconds(59'000));
}

TEST_F(PostgresLinkTest, AnEndedSessionIsReplacedByTheNextCall) {
  PostgresDatabase database;
  const auto store = Open(database.url());
  ASSERT_TRUE(store.ok()) << store.status();
  ASSERT_TRUE((*store)->Sweep(SystemTime()).ok());
  database.Shell().Run(
      "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = current_database()"
      " AND pid <> pg_backend_pid()");
  const auto broken = (*store)->Sweep(SystemTime());
  EXPECT_TRUE(absl::IsUnavailable(broken.status())) << broken.status();
  ASSERT_TRUE((*store)->InDoubt());
  ASSERT_TRUE((*store)->Compare({}).ok());
  (*store)->EndDoubt();
  EXPECT_TRUE((*store)->Sweep(SystemTime()).ok());
}

TEST_F(PostgresLinkTest, AReaderNeedsNoServerToOpen) {
  ReaderOptions options;
  options.url = "postgresql://uplinkd@127.0.0.1:1/x";
  const auto reader = PostgresReader::Open(options, clock_);
  ASSERT_TRUE(reader.ok()) << reader.status();
  EXPECT_TRUE(absl::IsUnavailable((*reader)->Robots(1).status()));
}

}  // namespace
}  // namespace uplink::storage::postgres
