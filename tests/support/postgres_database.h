#pragma once

#include <memory>
#include <string>
#include <string_view>

struct pg_conn;

namespace uplink::testing {

/// The private cluster of the test run, as UPLINK_TEST_POSTGRES names its state file; ctest starts
/// it. Aborts with the remedy if there is none.
struct PostgresCluster {
  /// Of its socket.
  std::string folder;
  std::string port;

  [[nodiscard]] static PostgresCluster FromEnvironment();
  /// `postgresql://role@/database?host=...` by the socket, where every role is trusted.
  [[nodiscard]] std::string Url(std::string_view role, std::string_view database) const;
  /// By TCP, where a role needs its password.
  [[nodiscard]] std::string TcpUrl(std::string_view role, std::string_view database) const;
};

/// A session beside the store's, as an operator's psql is. Failures abort with the server's
/// message.
class PostgresShell final {
 public:
  explicit PostgresShell(const std::string& url);

  void Run(const std::string& sql);
  /// All values of all rows, `|` between columns, a line end after each row.
  [[nodiscard]] std::string Read(const std::string& sql);

 private:
  struct Close {
    void operator()(pg_conn* connection) const;
  };
  std::unique_ptr<pg_conn, Close> connection_;
};

enum class DatabaseContent : bool { kEmpty, kMigrated };

/// A database of its own for one test: empty, or migrated with the partitions of the day before the
/// suite's time and the two after. Dropped at the end, even with clients still connected.
class PostgresDatabase final {
 public:
  explicit PostgresDatabase(DatabaseContent content = DatabaseContent::kMigrated);
  ~PostgresDatabase();
  PostgresDatabase(const PostgresDatabase&) = delete;
  PostgresDatabase& operator=(const PostgresDatabase&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  /// As the role that serves: the least that it needs.
  [[nodiscard]] std::string url() const { return cluster_.Url("uplinkd", name_); }
  [[nodiscard]] std::string owner_url() const { return cluster_.Url("uplinkd_owner", name_); }
  [[nodiscard]] std::string superuser_url() const { return cluster_.Url("postgres", name_); }
  [[nodiscard]] const PostgresCluster& cluster() const { return cluster_; }
  /// A session as the superuser.
  [[nodiscard]] PostgresShell Shell() const { return PostgresShell(superuser_url()); }

 private:
  const PostgresCluster cluster_ = PostgresCluster::FromEnvironment();
  std::string name_;
};

}  // namespace uplink::testing
