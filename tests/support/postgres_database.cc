#include "tests/support/postgres_database.h"

#include <cstdlib>
#include <fstream>
#include <random>

#include <libpq-fe.h>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"
#include "storage/postgres/migrations.h"
#include "storage/postgres/schema.h"

namespace uplink::testing {
namespace {

constexpr const char* kTemplate = "uplink_template";

std::string ValueOf(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    if (line.starts_with(key + "=")) return line.substr(key.size() + 1);
  }
  return "";
}

void MigrateTemplate(const PostgresCluster& cluster) {
  const SystemClock clock;
  auto url = storage::postgres::ParseUrl(cluster.Url("uplinkd_owner", kTemplate));
  UPLINK_CHECK(url.ok(), url.status().ToString());
  storage::postgres::ConnectionOptions options;
  options.url = *std::move(url);
  auto connection = storage::postgres::Connection::Open(options, clock);
  UPLINK_CHECK(connection.ok(), connection.status().ToString());
  const auto steps = storage::postgres::Migrate(**connection, storage::postgres::Migrations());
  UPLINK_CHECK(steps.ok(), steps.status().ToString());
  const absl::Status granted = storage::postgres::GrantTo(**connection, "uplinkd");
  UPLINK_CHECK(granted.ok(), granted.ToString());
}

/// The first test that needs it makes the template; others wait.
void EnsureTemplate(const PostgresCluster& cluster, PostgresShell& shell) {
  shell.Run("SELECT pg_advisory_lock(1)");
  const std::string name = kTemplate;
  if (shell.Read("SELECT 1 FROM pg_database WHERE datistemplate AND datname = '" + name + "'")
          .empty()) {
    shell.Run("DROP DATABASE IF EXISTS " + name);
    shell.Run("CREATE DATABASE " + name + " OWNER uplinkd_owner");
    MigrateTemplate(cluster);
    PostgresShell(cluster.Url("uplinkd_owner", name))
        .Run("SELECT uplinkd.make_partitions('2025-11-20', 3)");
    shell.Run("ALTER DATABASE " + name + " IS_TEMPLATE true");
  }
  shell.Run("SELECT pg_advisory_unlock(1)");
}

}  // namespace

PostgresCluster PostgresCluster::FromEnvironment() {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing in the tests changes the environment
  const char* state = std::getenv("UPLINK_TEST_POSTGRES");
  UPLINK_CHECK(state != nullptr,
               "UPLINK_TEST_POSTGRES names no cluster: run `tools/dev/postgres.sh start FILE` and"
               " set it to FILE, or run the test by ctest");
  PostgresCluster cluster{ValueOf(state, "folder"), ValueOf(state, "port")};
  UPLINK_CHECK(!cluster.folder.empty(), "the cluster of UPLINK_TEST_POSTGRES is stopped");
  return cluster;
}

std::string PostgresCluster::Url(std::string_view role, std::string_view database) const {
  std::string url = "postgresql://";
  url += role;
  url += "@/";
  url += database;
  return url + "?host=" + folder + "&port=" + port;
}

std::string PostgresCluster::TcpUrl(std::string_view role, std::string_view database) const {
  std::string url = "postgresql://";
  url += role;
  url += "@127.0.0.1:" + port + "/";
  url += database;
  return url;
}

void PostgresShell::Close::operator()(pg_conn* connection) const { PQfinish(connection); }

PostgresShell::PostgresShell(const std::string& url) : connection_(PQconnectdb(url.c_str())) {
  UPLINK_CHECK(PQstatus(connection_.get()) == CONNECTION_OK, PQerrorMessage(connection_.get()));
  PQsetNoticeProcessor(
      connection_.get(), [](void*, const char*) {}, nullptr);
}

void PostgresShell::Run(const std::string& sql) { static_cast<void>(Read(sql)); }

std::string PostgresShell::Read(const std::string& sql) {
  const std::unique_ptr<PGresult, void (*)(PGresult*)> result(
      PQexec(connection_.get(), sql.c_str()), PQclear);
  const ExecStatusType status = PQresultStatus(result.get());
  UPLINK_CHECK(status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK,
               PQerrorMessage(connection_.get()));
  std::string text;
  for (int row = 0; row < PQntuples(result.get()); ++row) {
    for (int column = 0; column < PQnfields(result.get()); ++column) {
      if (column > 0) text += '|';
      text += PQgetvalue(result.get(), row, column);
    }
    text += '\n';
  }
  return text;
}

PostgresDatabase::PostgresDatabase(DatabaseContent content)
    : name_("t" + std::to_string(std::random_device{}())) {
  PostgresShell shell(cluster_.Url("postgres", "postgres"));
  if (content == DatabaseContent::kEmpty) {
    shell.Run("CREATE DATABASE " + name_ + " OWNER uplinkd_owner");
    return;
  }
  EnsureTemplate(cluster_, shell);
  shell.Run("CREATE DATABASE " + name_ + " OWNER uplinkd_owner TEMPLATE " + kTemplate);
}

PostgresDatabase::~PostgresDatabase() {
  PostgresShell(cluster_.Url("postgres", "postgres"))
      .Run("DROP DATABASE IF EXISTS " + name_ + " WITH (FORCE)");
}

}  // namespace uplink::testing
