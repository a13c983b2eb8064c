#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"

namespace uplink::storage::postgres {

/// The oldest server that is supported: PostgreSQL 13.
inline constexpr std::int64_t kServerVersionMin = 130'000;

/// What a server said of itself when it was connected to.
struct ServerFacts {
  /// `15.4` is 150004.
  std::int64_t version = 0;
  /// A loss of power may lose what was committed.
  bool unsafe = false;
  bool read_only = false;
  bool standby = false;
  /// Texts of any language can be stored.
  bool utf8 = true;
  /// The server's clock less ours.
  milliseconds clock_offset{0};
  /// Store::ServerRun: when its postmaster started, and the number of the database. A standby that
  /// takes over, a server that was started anew and a database that was restored have another one.
  std::string run;
};

[[nodiscard]] absl::StatusOr<ServerFacts> AskServer(Connection& connection, const Clock& clock);

enum class Purpose : std::uint8_t { kWrite, kRead };

/// A connection that is made when it is needed, and made anew after it broke. Each new one is
/// checked before its first use: version, schema, fsync, whether it takes writes.
///
/// Thread: confined to one thread at a time.
class Link final {
 public:
  struct Options {
    ConnectionOptions connection;
    Purpose purpose = Purpose::kWrite;
    /// Accept a server with fsync = off.
    bool accept_unsafe = false;
    /// If the schema shuts this program out: refuse the caller once, and accept the schema from
    /// then on, so that such a program can still write what an orderly stop needs.
    bool when_shut_out = false;
    /// Apply missing migrations before the first connection, whenever that comes.
    bool migrate = false;
  };

  /// `clock` must outlive this.
  Link(Options options, const Clock& clock)
      : options_(std::move(options)), clock_(clock), to_migrate_(options_.migrate) {}

  /// A connection that is not known to be broken; connects if there is none.
  ///
  /// Errors: of Connection::Open; kFailedPrecondition for a server that must not be used.
  [[nodiscard]] absl::StatusOr<Connection*> Get();
  /// How often it was connected to so far.
  [[nodiscard]] std::uint64_t connections() const { return connections_; }
  /// The last connection is not known to be broken.
  [[nodiscard]] bool connected() const { return connection_ != nullptr && !connection_->broken(); }
  /// Connection::died, of the last connection.
  [[nodiscard]] bool died() const { return connection_ != nullptr && connection_->died(); }
  /// What the last server that was connected to said.
  [[nodiscard]] const ServerFacts& facts() const { return facts_; }

 private:
  absl::Status Check(Connection& connection);
  absl::Status MigrateFirst();

  const Options options_;
  const Clock& clock_;
  ServerFacts facts_;
  bool to_migrate_;
  bool shut_out_ = false;
  std::uint64_t connections_ = 0;
  std::unique_ptr<Connection> connection_;
};

/// What `once` answers: a read that uses a connection of `link`. Asked a second time if the
/// connection stood before and turned out to have died: while it was idle the server, a pooler
/// or a firewall ended it, and a new one may do. Not for what writes.
template <typename Once>
auto ReadAgainIfDied(const Link& link, const Once& once) -> decltype(once()) {
  const bool stood = link.connected();
  auto result = once();
  if (!stood || !link.died()) return result;
  return once();
}

/// A session that migrates begins with this: no timeout of its role, its database or the server
/// ends a step, which may take long and wait for others' locks. The timeout of its call bounds it.
/// PostgreSQL has `idle_session_timeout` from 14 on and `transaction_timeout` from 17 on.
inline constexpr std::string_view kNoTimeouts =
    "SET statement_timeout = 0; SET lock_timeout = 0; SET idle_in_transaction_session_timeout = 0;"
    " SELECT pg_catalog.set_config(name, '0', false) FROM pg_catalog.pg_settings"
    " WHERE name IN ('idle_session_timeout', 'transaction_timeout');";
/// The statements that a session begins with. `statement_timeout`: what one statement may take.
[[nodiscard]] std::string SessionSettings(Purpose purpose, milliseconds statement_timeout);

}  // namespace uplink::storage::postgres
