#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "storage/leases.h"
#include "storage/store.h"
#include "tests/simulation/holders_truth.h"
#include "tests/simulation/random.h"
#include "tests/support/fake_leases.h"
#include "tests/support/fake_store.h"

namespace uplink::simulation {

/// A fault that is planted into a run: one that the checks do not find shows that they check
/// nothing.
enum class HoldersFault : std::uint8_t {
  kNone,
  /// The store takes changes of presence from any process.
  kHoldNotChecked,
  /// After a failed look every other process counts as released.
  kOverAfterAFailedLook,
  /// A robot is adopted even if another process holds it by then.
  kAdoptedWithoutCompare,
  /// A stream that has ended takes its robot like one that has not.
  kEndedStreamTakes,
  /// After a standstill robots are judged at once, though what they sent lies unread.
  kStandstillJudges,
  /// A process that stops calls its robots unknown though others take them over.
  kStopsWithUnknown,
  /// The robots of a process that may live are offline after the grace of a start.
  kShortGrace,
  /// That a holder fell silent is forgotten when its robots are adopted once more.
  kSilenceForgotten,
  /// Robots that may stream to a process that is cut off from the store are judged like others.
  kLateIsForgotten,
  /// Silence counts though the peer is gone and cannot answer a ping.
  kHalfOpenAnswers,
  /// After a standstill robots have no more time to come back than after a start without a grace.
  kNoGraceAfterStandstill,
  /// A suspend of the machine goes unnoticed.
  kSuspendUnnoticed,
  /// A robot's epochs begin anew with its row.
  kEpochsInEachRow,
  /// Silence before a reconnect to the store does not count, even if the server is the same one.
  kReconnectExcuses,
  kLast = kReconnectExcuses,
};

/// The way of one process to the store: what is asked passes a planted fault, and answers can be
/// lost. What arrives at the store is told to the truth.
///
/// Thread: confined to its caller.
class HoldersStore final : public storage::Store {
 public:
  /// The references outlive it.
  struct Context {
    testing::FakeDatabase& database;
    HoldersTruth& truth;
    Random& random;
    storage::ProcessId process{};
    /// For people, and in place of where it runs: all processes of a simulation are one.
    std::string name;
    HoldersFault fault = HoldersFault::kNone;
    /// Whether a stream of the robot is at this process.
    HoldersTruth::HasStream has_stream;
  };
  explicit HoldersStore(Context context);

  /// Every call fails until false.
  void SetAway(bool away) { away_ = away; }
  [[nodiscard]] bool away() const { return away_; }
  /// The connections of writer and lease end: the next call over each finds that, and what the
  /// store has may be less than it told.
  void Break() { broken_ = lease_broken_ = true; }
  [[nodiscard]] bool TakeLeaseBreak() { return std::exchange(lease_broken_, false); }
  /// So many of a hundred calls fail, half of them after they were carried out.
  void SetLossy(std::uint32_t percent) { lost_percent_ = percent; }
  [[nodiscard]] storage::Reader& reader() { return store_; }

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
  [[nodiscard]] absl::StatusOr<std::vector<storage::ProcessId>> ProcessesWithOpenConnections()
      override;
  [[nodiscard]] absl::StatusOr<std::size_t> EndConnections(const storage::ProcessId& process,
                                                           SystemTime now) override;
  [[nodiscard]] std::size_t TakeRunsClosed() override;
  [[nodiscard]] absl::StatusOr<storage::Trimmed> TrimQuarantine(
      std::span<const std::string> ruris) override;
  [[nodiscard]] absl::StatusOr<storage::Erased> Retain(SystemTime now) override;
  [[nodiscard]] absl::StatusOr<std::vector<std::size_t>> Checkpoint(
      std::span<const storage::LiveRow> rows) override;
  [[nodiscard]] bool InDoubt() const override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::FoundRobot>> Compare(
      std::span<const storage::ToldRobot> robots) override;
  [[nodiscard]] std::string ServerRun() const override { return store_.ServerRun(); }
  void EndDoubt() override;

 private:
  /// Carries the call out, unless it is lost on its way; its answer may be.
  template <typename Call>
  auto Pass(const Call& call) -> decltype(call());
  /// Whether a call comes through to the store.
  [[nodiscard]] bool Reaches();
  /// HoldersFault::kAdoptedWithoutCompare: names the holders that the rows have by now.
  void TrustRows(std::vector<storage::AdoptRequest>& requests) const;

  const Context context_;
  testing::FakeStore store_;
  bool away_ = false;
  bool broken_ = false;
  bool lease_broken_ = false;
  std::uint32_t lost_percent_ = 0;
};

/// The leases as one process has them, with the planted fault, told to the truth.
class HoldersLeases final : public storage::Leases {
 public:
  /// Both outlive it.
  HoldersLeases(HoldersStore& line, const HoldersStore::Context& context);

  [[nodiscard]] std::string ServerRun() const override { return leases_.ServerRun(); }
  [[nodiscard]] absl::Status Renew(const storage::ProcessCard& card) override;
  [[nodiscard]] absl::Status Release() override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::Lease>> Read() override;
  [[nodiscard]] absl::StatusOr<std::vector<storage::ForeignRobot>> RobotsOfOthers(
      std::string_view after) override;

 private:
  /// As the way to the store is now.
  testing::FakeLeases& Now();

  HoldersStore& line_;
  const HoldersStore::Context context_;
  testing::FakeLeases leases_;
  bool failed_ = false;
};

}  // namespace uplink::simulation
