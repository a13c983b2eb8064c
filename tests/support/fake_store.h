#pragma once

#include <condition_variable>
#include <cstdint>
#include <initializer_list>
#include <mutex>
#include <span>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/reader.h"
#include "storage/store.h"
#include "tests/support/fake_database.h"

namespace uplink::testing {

/// Where a call of FakeStore that fails does so.
enum class FailAt : std::uint8_t {
  /// Nothing of it was written.
  kBefore,
  /// All of it was written; the answer is lost.
  kAfter,
};

/// One process's connection to a FakeDatabase, with the faults that a test orders. It passes the
/// contract suite in tests/contract.
///
/// Thread: thread-safe, so that a test may order faults while a writer thread works.
class FakeStore final : public storage::Store, public storage::Reader {
 public:
  /// `database` must outlive this.
  FakeStore(FakeDatabase& database, const storage::ProcessId& process,
            const storage::StoreRules& rules = {});
  ~FakeStore() override;

  // storage::Store
  [[nodiscard]] absl::StatusOr<std::vector<storage::OpenResult>> OpenStreams(
      std::span<const storage::OpenRequest> requests) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::AdoptResult>> Adopt(
      std::span<const storage::AdoptRequest> requests) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::Outcome>> Commit(
      const storage::Batch& batch) override;
  [[nodiscard]] absl::StatusOr<storage::Swept> Sweep(SystemTime now) override;
  [[nodiscard]] absl::StatusOr<std::size_t> CloseRuns(SystemTime now) override;
  [[nodiscard]] std::size_t TakeRunsClosed() override;
  [[nodiscard]] absl::StatusOr<storage::Trimmed> TrimQuarantine(
      std::span<const std::string> ruris) override;
  [[nodiscard]] absl::StatusOr<storage::Erased> Retain(SystemTime now) override;
  [[nodiscard]] absl::StatusOr<std::vector<std::size_t>> Checkpoint(
      std::span<const storage::LiveRow> rows) override;
  [[nodiscard]] bool InDoubt() const override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::FoundRobot>> Compare(
      std::span<const storage::ToldRobot> robots) override;
  [[nodiscard]] std::string ServerRun() const override { return database_.ServerRun(); }
  void EndDoubt() override;

  // storage::Reader
  [[nodiscard]] absl::StatusOr<std::vector<storage::RobotRow>> Robots(
      std::uint32_t robots_max) override;
  [[nodiscard]] absl::StatusOr<std::size_t> RobotCount() override;
  [[nodiscard]] absl::StatusOr<std::vector<std::string>> FleetsBeyondAscii(
      std::uint32_t fleets_max) override;
  // NOLINTBEGIN(bugprone-macro-parentheses): the arguments are names of types and functions
#define UPLINK_LIST(Name, number, Row, Query, retained)                                       \
  [[nodiscard]] absl::StatusOr<storage::Page<storage::Row>> Name(const storage::Query& query) \
      override;
  UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST
  // NOLINTEND(bugprone-macro-parentheses)
  [[nodiscard]] absl::StatusOr<std::vector<storage::DroppedRow>> QuarantineDropped(
      const std::string& ruri) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::StoredReject>> Rejects(
      const storage::RejectsQuery& query) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::ActiveFaults>> ActiveFaultCounts(
      std::span<const std::string> ruris) override;
  [[nodiscard]] absl::StatusOr<LatestRows> Latest(std::span<const std::string> ruris,
                                                  storage::LatestKindSet kinds) override;
  [[nodiscard]] absl::StatusOr<LiveRows> LiveOf(std::span<const std::string> ruris) override;

  /// The connection breaks in the `calls`-th Compare from now, which fails.
  void BreakAtCompare(std::uint64_t calls);
  /// The connection breaks: InDoubt until EndDoubt, and every other call fails.
  void Break();

  // Faults; each set of orders is worked off before the next of its kind.
  /// The next `calls` calls of OpenStreams, Adopt, Commit or TrimQuarantine fail; FailAt::kBefore
  /// goes first.
  void FailNext(std::uint32_t calls, FailAt at,
                const absl::Status& status = absl::UnavailableError("the test said so"));
  /// As FailNext, for Commit alone.
  void FailNextCommits(std::uint32_t calls, FailAt at,
                       const absl::Status& status = absl::UnavailableError("the test said so"));
  /// As FailNext, for OpenStreams alone.
  void FailNextOpens(std::uint32_t calls, FailAt at,
                     const absl::Status& status = absl::UnavailableError("the test said so"));
  /// As FailNext, for Sweep and CloseRuns alone.
  void FailNextSweeps(std::uint32_t calls, FailAt at,
                      const absl::Status& status = absl::UnavailableError("the test said so"));
  /// As FailNext, for Checkpoint alone.
  void FailNextCheckpoints(std::uint32_t calls, FailAt at,
                           const absl::Status& status = absl::UnavailableError("the test said so"));
  /// As FailNext, for TrimQuarantine alone.
  void FailNextTrims(std::uint32_t calls, FailAt at,
                     const absl::Status& status = absl::UnavailableError("the test said so"));
  /// As FailNext, for Retain alone.
  void FailNextRetains(std::uint32_t calls, FailAt at,
                       const absl::Status& status = absl::UnavailableError("the test said so"));
  /// No ordered failure is left, and nothing blocks.
  void Heal();
  void SetRules(FakeRules rules);

  // For tests with real threads.
  /// Write calls wait until Release. Release before the threads that call are joined.
  void Block();
  void Release();
  /// True once a write call waits; false after `deadline`.
  [[nodiscard]] bool WaitUntilBlocked(milliseconds deadline);

  /// Write calls that came back, with whatever answer.
  [[nodiscard]] std::uint64_t commits() const;
  [[nodiscard]] std::uint64_t opens() const;
  [[nodiscard]] std::uint64_t adopts() const;
  [[nodiscard]] std::uint64_t sweeps() const;
  [[nodiscard]] std::uint64_t trims() const;
  [[nodiscard]] std::uint64_t checkpoints() const;
  [[nodiscard]] std::uint64_t compares() const;

 private:
  struct Order {
    std::uint32_t before = 0;
    std::uint32_t after = 0;
    absl::Status status;
  };

  /// What to do with the call that begins: waits while blocked, then takes from the first of
  /// `orders` that holds any.
  struct Fate {
    bool fail_before = false;
    bool fail_after = false;
    absl::Status status;
    FakeRules rules;
  };
  Fate Begin(std::initializer_list<Order*> orders, std::uint64_t& calls);
  void Add(Order& order, std::uint32_t calls, FailAt at, const absl::Status& status);

  FakeDatabase& database_;
  const storage::ProcessId process_;
  const storage::StoreRules store_rules_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool blocked_ = false;
  std::uint32_t waiting_ = 0;
  bool in_doubt_ = false;
  /// The number of the Compare in which the connection breaks; 0: of none.
  std::uint64_t break_at_compare_ = 0;
  Order any_order_;
  Order commit_order_;
  Order open_order_;
  Order sweep_order_;
  Order trim_order_;
  Order retain_order_;
  Order checkpoint_order_;
  FakeRules rules_;
  std::uint64_t commits_ = 0;
  std::uint64_t opens_ = 0;
  std::uint64_t adopts_ = 0;
  std::uint64_t sweeps_ = 0;
  std::uint64_t closes_ = 0;
  std::uint64_t trims_ = 0;
  std::size_t runs_closed_taken_ = 0;
  std::uint64_t retains_ = 0;
  std::uint64_t checkpoints_ = 0;
  std::uint64_t compares_ = 0;
};

}  // namespace uplink::testing
