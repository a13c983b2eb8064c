// Where a server keeps its database, if this process may know it.
#include <fstream>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "storage/disk_space.h"
#include "storage/postgres/data_folder.h"
#include "storage/postgres/reader.h"
#include "tests/support/postgres_database.h"
#include "tests/support/temp_folder.h"

namespace uplink::storage::postgres {
namespace {

using testing::PostgresDatabase;
using testing::PostgresShell;

class PostgresDataFolderTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string FolderBy(const std::string& url,
                                     const std::string& password_file = "") const {
    ConnectionOptions options;
    options.url = *ParseUrl(url);
    options.password_file = password_file;
    const auto connection = Connection::Open(options, clock_);
    EXPECT_TRUE(connection.ok()) << connection.status();
    const auto folder = ReadDataFolder(**connection);
    EXPECT_TRUE(folder.ok()) << folder.status();
    return folder.value_or("error");
  }
  [[nodiscard]] std::unique_ptr<PostgresReader> ReaderBy(const std::string& url) const {
    ReaderOptions options;
    options.url = url;
    return *PostgresReader::Open(options, clock_);
  }
  [[nodiscard]] std::string DataFolder() const {
    std::string folder = database_.Shell().Read("SHOW data_directory");
    folder.pop_back();
    return folder;
  }

  const SystemClock clock_{};
  PostgresDatabase database_;
};

TEST_F(PostgresDataFolderTest, ByASocketIsKnownToWhoMayReadTheSetting) {
  EXPECT_EQ(FolderBy(database_.superuser_url()), DataFolder());
  const auto space = ReaderBy(database_.superuser_url())->Space();
  ASSERT_TRUE(space.ok() && *space) << space.status();
  EXPECT_EQ((*space)->total_bytes, DiskSpaceOf(DataFolder())->total_bytes);
}

TEST_F(PostgresDataFolderTest, IsNotKnownToARoleThatMayOnlyServe) {
  EXPECT_EQ(FolderBy(database_.url()), "");
  const auto space = ReaderBy(database_.url())->Space();
  ASSERT_TRUE(space.ok()) << space.status();
  EXPECT_FALSE(space->has_value());
}

TEST_F(PostgresDataFolderTest, IsNotKnownByTheNetwork) {
  PostgresShell shell = database_.Shell();
  const std::string role = "reads_settings_" + database_.name();
  shell.Run("CREATE ROLE " + role + " LOGIN PASSWORD 'secret' IN ROLE pg_read_all_settings");
  const testing::TempFolder folder;
  const std::string password = folder.File("password");
  std::ofstream(password) << "secret\n";
  EXPECT_EQ(FolderBy(database_.cluster().Url(role, database_.name())), DataFolder());
  EXPECT_EQ(FolderBy(database_.cluster().TcpUrl(role, database_.name()), password), "");
  shell.Run("DROP ROLE " + role);
}

}  // namespace
}  // namespace uplink::storage::postgres
