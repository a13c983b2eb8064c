#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/disk_space.h"
#include "storage/sqlite/damage.h"
#include "storage/store.h"
#include "storage/store_rules.h"

namespace uplink::storage::sqlite {

struct StoreOptions {
  /// This process; other than in any life before.
  ProcessId process{};
  StoreRules rules;
  /// False: a file that is older than the program is refused.
  bool migrate = true;
  /// False: no lock keeps a second writer away. For tests of two processes on one store.
  bool exclusive = true;
  /// How long a call waits for another writer of the file (a backup, the sqlite3 shell).
  milliseconds busy_timeout{5'000};
  /// The largest file, in pages of 4 KiB; past it the store is full. Nothing: as the disk allows.
  std::optional<std::int64_t> pages_max;
  /// Told if an earlier process found damage, so that the whole file is read first; may be empty.
  OnDamageCheck on_damage_check;
  /// What the disk has left, in place of DiskSpaceOf. For tests.
  std::function<absl::StatusOr<DiskSpace>(const std::string&)> disk_space = DiskSpaceOf;
  /// Called in each write transaction right before its commit; what is not OK rolls it back and is
  /// the answer. For tests.
  std::function<absl::Status()> before_commit;
  /// Called right after each commit; what is not OK is the answer, as if the true one was lost. For
  /// tests.
  std::function<absl::Status()> after_commit;
};

/// The embedded store: one SQLite file in WAL mode, durable at each return (synchronous FULL).
///
/// Errors:  of Open, kFailedPrecondition above all, naming the path: no such folder, no permission,
///          another process writes the file, no file of ours, a newer or an older schema. Of the
///          calls, as in Store.
/// Thread:  as in Store.
class SqliteStore final : public Store {
 public:
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<SqliteStore>> Open(
      const std::string& path, const StoreOptions& options);
  ~SqliteStore() override;
  SqliteStore(const SqliteStore&) = delete;
  SqliteStore& operator=(const SqliteStore&) = delete;

  /// What other connections of this process to the file report to, so that nothing is acked once
  /// one of them found damage. Any thread.
  [[nodiscard]] DamagePtr damage() const;

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
  [[nodiscard]] absl::StatusOr<std::vector<FoundRobot>> Compare(
      std::span<const ToldRobot> robots) override;
  /// A file has no connection to lose: one that may lack what was told fails for good (Damage).
  [[nodiscard]] bool InDoubt() const override { return false; }
  void EndDoubt() override {}

 private:
  struct Impl;
  explicit SqliteStore(std::unique_ptr<Impl> impl);

  /// Runs `work` in a transaction of its own; all or nothing.
  template <typename Work>
  auto InTransaction(const Work& work) -> std::invoke_result_t<Work>;

  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::storage::sqlite
