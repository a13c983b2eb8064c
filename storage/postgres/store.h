#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/postgres/defaults.h"
#include "storage/store.h"
#include "storage/store_facts.h"
#include "storage/store_rules.h"

namespace uplink::storage::postgres {

class Connection;

struct StoreOptions {
  /// `postgresql://...`, without a password.
  std::string url;
  /// A file whose first line is the password; empty: as libpq finds one (~/.pgpass, PGPASSFILE).
  std::string password_file;
  /// This process; it must differ in every life of the process.
  ProcessId process{};
  StoreRules rules;
  /// Apply missing migrations at the first connection, as a role that may.
  bool migrate = false;
  /// Connect in Open already; false: at the first call.
  bool connect_now = true;
  /// Accept a server with fsync = off.
  bool accept_unsafe = false;
  milliseconds connect_timeout{5'000};
  /// How long one call of the store may take at most.
  milliseconds call_timeout = kCallTimeoutDefault;
  /// Called in each write transaction right before its commit; what is not OK rolls it back and is
  /// the answer. For tests.
  std::function<absl::Status()> before_commit;
  /// Called right after each commit; what is not OK is the answer, as if the true one was lost. For
  /// tests.
  std::function<absl::Status()> after_commit;
};

/// A PostgreSQL database as the durable sink: one connection, made anew whenever it breaks.
///
/// Errors:  as in Store; kUnavailable while the server is away, and every call tries again.
/// Thread:  as in Store.
class PostgresStore final : public Store {
 public:
  /// Connects and looks whether the database is fit. A server that cannot be reached now is no
  /// error: `last_error` holds why, and calls try again. `clock` must outlive the store.
  ///
  /// Errors: kInvalidArgument for the URL; kFailedPrecondition and kInternal for a server that is
  ///         there and cannot be used as it is: password, schema, read-only, fsync = off.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<PostgresStore>> Open(StoreOptions options,
                                                                           const Clock& clock);
  ~PostgresStore() override;
  PostgresStore(const PostgresStore&) = delete;
  PostgresStore& operator=(const PostgresStore&) = delete;

  [[nodiscard]] absl::StatusOr<std::vector<OpenResult>> OpenStreams(
      std::span<const OpenRequest> requests) override;
  [[nodiscard]] absl::StatusOr<std::vector<AdoptResult>> Adopt(
      std::span<const AdoptRequest> requests) override;
  [[nodiscard]] absl::StatusOr<std::vector<ClaimResult>> ClaimDrones(
      std::span<const ClaimRequest> requests) override;
  [[nodiscard]] absl::StatusOr<std::vector<Outcome>> Commit(const Batch& batch) override;
  [[nodiscard]] absl::StatusOr<Swept> Sweep(SystemTime now) override;
  [[nodiscard]] absl::StatusOr<std::size_t> CloseRuns(SystemTime now) override;
  [[nodiscard]] std::size_t TakeRunsClosed() override;
  [[nodiscard]] absl::StatusOr<std::vector<ProcessId>> ProcessesWithOpenConnections() override;
  [[nodiscard]] absl::StatusOr<std::size_t> EndConnections(const ProcessId& process,
                                                           SystemTime now) override;
  [[nodiscard]] absl::StatusOr<Trimmed> TrimQuarantine(std::span<const std::string> ruris) override;
  [[nodiscard]] absl::StatusOr<Erased> Retain(SystemTime now) override;
  [[nodiscard]] absl::StatusOr<std::vector<std::size_t>> Checkpoint(
      std::span<const LiveRow> rows) override;
  [[nodiscard]] bool InDoubt() const override;
  [[nodiscard]] absl::StatusOr<std::vector<FoundRobot>> Compare(
      std::span<const ToldRobot> robots) override;
  [[nodiscard]] std::string ServerRun() const override;
  void EndDoubt() override;

  /// Of Open: why the server could not be reached; OK if it could.
  [[nodiscard]] const absl::Status& open_error() const;
  /// As of the last connection, and what was counted since the start. Any thread.
  [[nodiscard]] StoreFacts facts() const;

 private:
  struct Impl;
  explicit PostgresStore(std::unique_ptr<Impl> impl);

  /// Runs `work` with a connection, again where transactions stood in each other's way.
  template <typename Work>
  auto With(const Work& work) -> std::invoke_result_t<Work, Connection&>;

  std::unique_ptr<Impl> impl_;
};

/// True for errors that a later try may not meet: the server is away, busy or full.
[[nodiscard]] bool IsWorthRetry(const absl::Status& status);

}  // namespace uplink::storage::postgres
