#pragma once

#include <condition_variable>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/store.h"
#include "tests/support/fake_database.h"
#include "tests/support/fake_reader.h"

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
class FakeStore final : public storage::Store, public FakeReader {
 public:
  /// `database` must outlive this.
  FakeStore(FakeDatabase& database, const storage::ProcessId& process,
            const storage::StoreRules& rules = {})
      : FakeReader(database), database_(database), process_(process), store_rules_(rules) {}

  // storage::Store
  [[nodiscard]] absl::StatusOr<std::vector<storage::OpenResult>> OpenStreams(
      std::span<const storage::OpenRequest> requests) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::AdoptResult>> Adopt(
      std::span<const storage::AdoptRequest> requests) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::ClaimResult>> ClaimDrones(
      std::span<const storage::ClaimRequest> requests) override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::Outcome>> Commit(
      const storage::Batch& batch) override;
  [[nodiscard]] absl::StatusOr<storage::Swept> Sweep(SystemTime now) override;
  [[nodiscard]] absl::StatusOr<std::size_t> CloseRuns(SystemTime now) override;
  [[nodiscard]] std::size_t TakeRunsClosed() override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::ProcessId>> ProcessesWithOpenConnections()
      override;
  [[nodiscard]] absl::StatusOr<std::size_t> EndConnections(const storage::ProcessId& process,
                                                           SystemTime now) override;
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

  /// The connection breaks in the `calls`-th Compare from now, which fails.
  void BreakAtCompare(std::uint64_t calls);
  /// The connection breaks: InDoubt until EndDoubt, and every other call fails.
  void Break();

  // Faults; each set of orders is worked off before the next of its kind.
  /// The next `calls` calls of OpenStreams, Adopt, ClaimDrones, Commit or TrimQuarantine fail;
  /// FailAt::kBefore goes first.
  void FailNext(std::uint32_t calls, FailAt at, const absl::Status& status = Injected()) {
    Add(Orders::kAny, calls, at, status);
  }
  // The same for one kind of call alone.
  void FailNextCommits(std::uint32_t calls, FailAt at, const absl::Status& status = Injected()) {
    Add(Orders::kCommits, calls, at, status);
  }
  void FailNextOpens(std::uint32_t calls, FailAt at, const absl::Status& status = Injected()) {
    Add(Orders::kOpens, calls, at, status);
  }
  void FailNextClaims(std::uint32_t calls, FailAt at, const absl::Status& status = Injected()) {
    Add(Orders::kClaims, calls, at, status);
  }
  /// Sweep, CloseRuns, ProcessesWithOpenConnections and EndConnections.
  void FailNextSweeps(std::uint32_t calls, FailAt at, const absl::Status& status = Injected()) {
    Add(Orders::kSweeps, calls, at, status);
  }
  void FailNextCheckpoints(std::uint32_t calls, FailAt at,
                           const absl::Status& status = Injected()) {
    Add(Orders::kCheckpoints, calls, at, status);
  }
  void FailNextTrims(std::uint32_t calls, FailAt at, const absl::Status& status = Injected()) {
    Add(Orders::kTrims, calls, at, status);
  }
  void FailNextRetains(std::uint32_t calls, FailAt at, const absl::Status& status = Injected()) {
    Add(Orders::kRetains, calls, at, status);
  }
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
  [[nodiscard]] std::uint64_t commits() const { return Calls(Call::kCommit); }
  [[nodiscard]] std::uint64_t opens() const { return Calls(Call::kOpen); }
  [[nodiscard]] std::uint64_t adopts() const { return Calls(Call::kAdopt); }
  [[nodiscard]] std::uint64_t claims() const { return Calls(Call::kClaim); }
  [[nodiscard]] std::uint64_t sweeps() const { return Calls(Call::kSweep); }
  [[nodiscard]] std::uint64_t trims() const { return Calls(Call::kTrim); }
  [[nodiscard]] std::uint64_t checkpoints() const { return Calls(Call::kCheckpoint); }
  [[nodiscard]] std::uint64_t compares() const { return Calls(Call::kCompare); }

 private:
  enum class Call : std::uint8_t {
    kOpen,
    kAdopt,
    kClaim,
    kCommit,
    kSweep,
    kCloseRuns,
    kOpenProcesses,
    kEndConnections,
    kTrim,
    kRetain,
    kCheckpoint,
    kCompare
  };
  /// Which calls an order is for.
  enum class Orders : std::uint8_t {
    kAny,
    kCommits,
    kOpens,
    kClaims,
    kSweeps,
    kTrims,
    kRetains,
    kCheckpoints
  };
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
  Fate Begin(std::initializer_list<Orders> orders, Call call);
  /// Such a call that begins: `act` writes, under these rules.
  template <typename Act>
  auto Do(std::initializer_list<Orders> orders, Call call, Act act)
      -> absl::StatusOr<decltype(act(FakeRules()))> {
    Fate fate = Begin(orders, call);
    if (fate.fail_before) return std::move(fate.status);
    auto result = act(fate.rules);
    if (fate.fail_after) return std::move(fate.status);
    return result;
  }
  void Add(Orders orders, std::uint32_t calls, FailAt at, const absl::Status& status);
  [[nodiscard]] std::uint64_t Calls(Call call) const;
  static absl::Status Injected() { return absl::UnavailableError("the test said so"); }

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
  std::map<Orders, Order> orders_;
  FakeRules rules_;
  std::map<Call, std::uint64_t> calls_;
  std::size_t runs_closed_taken_ = 0;
};

}  // namespace uplink::testing
