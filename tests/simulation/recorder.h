#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "storage/store.h"
#include "tests/simulation/shared_book.h"

namespace uplink::simulation {

/// What is durable of one session, as the transactions that were really applied said.
struct DurableSession {
  std::set<model::Seq> stored;
  std::map<model::Seq, model::RejectReason> quarantined;
  model::Seq cursor = 0;
  /// How many of the stored ones are faults.
  std::size_t faults = 0;

  [[nodiscard]] bool Holds(model::Seq seq) const {
    return stored.contains(seq) || quarantined.contains(seq);
  }
};

/// How a call of the store fails: before it is applied, or with its answer lost.
enum class StoreFault : std::uint8_t { kNone, kBefore, kAfter };

/// Stands between the journal and a store: fails calls on order, before they are applied or with
/// their answer lost, and keeps book of what was applied. It outlives the processes; the store
/// below is set anew for each.
class Recorder final : public storage::Store {
 public:
  using Violation = std::function<void(const std::string&)>;
  explicit Recorder(Violation violation) : violation_(std::move(violation)) {}

  void Violate(const std::string& text) { violation_(text); }
  void SetStore(storage::Store* store);
  void FailNext(StoreFault fault) { fault_ = fault; }
  /// Every call fails before it is applied, until false.
  void SetAway(bool away) { away_ = away; }
  /// KeepCopy puts the book aside, with a copy of the store; GoBack takes it up again, as the store
  /// goes back to that. Until the process has reconnected it cannot know. `reconnected` is called
  /// then, before anything else is asked of the store.
  void KeepCopy() { copy_ = book_; }
  void GoBack(std::function<void()> reconnected);
  /// Whether the process may call the number durable.
  [[nodiscard]] bool MayBeTold(const std::string& ruri, const model::SessionId& session,
                               model::Seq seq);
  /// The robot's row in the store is about to be deleted; false if it has none.
  bool OnRowDeleted(const std::string& ruri);

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
  void EndDoubt() override;

  /// Each robot's last change of presence that was committed.
  [[nodiscard]] const std::map<std::string, model::Presence>& presence() const {
    return book_.presence;
  }
  /// Each robot's changes that were committed, each once, in order.
  [[nodiscard]] const std::map<std::string, std::vector<model::Presence>>& presence_history()
      const {
    return book_.presence_history;
  }

  /// Since when the store has the robot held; 0 where it has no row of it.
  [[nodiscard]] storage::Epoch HeldSince(const std::string& ruri) const {
    const auto row = book_.rows.find(ruri);
    return row == book_.rows.end() ? 0 : row->second;
  }

  /// What robots share.
  [[nodiscard]] SharedBook& shared() { return book_.shared; }

  [[nodiscard]] const DurableSession& Of(const std::string& ruri, const model::SessionId& session) {
    return book_.sessions[{ruri, session}];
  }
  [[nodiscard]] const std::map<std::pair<std::string, model::SessionId>, DurableSession>& sessions()
      const {
    return book_.sessions;
  }

 private:
  /// What was really applied.
  struct Book {
    /// Changes of presence may be missing: a row of a robot was deleted, and those that waited were
    /// dropped with its hold; or the store went back.
    bool skips_presence = false;
    std::map<std::pair<std::string, model::SessionId>, DurableSession> sessions;
    /// Robots that have a row in the store, with the hold in it.
    std::map<std::string, storage::Epoch> rows;
    std::map<model::SessionId, model::Seq> presence_cursors;
    std::map<std::string, model::Presence> presence;
    std::map<std::string, std::vector<model::Presence>> presence_history;
    SharedBook shared;
  };

  void Reconnect();
  void Note(const storage::CommitRecord& record, const storage::Outcome& outcome);
  void NotePresence(const storage::Batch& batch, std::span<const storage::Outcome> outcomes);
  /// Checks that nothing is stored while the robot has no row, and that nothing is fenced that was
  /// committed under the hold that the server was told.
  void CheckHold(const std::string& ruri, storage::Epoch held_since, storage::OutcomeKind outcome);

  const Violation violation_;
  storage::Store* store_ = nullptr;
  StoreFault fault_ = StoreFault::kNone;
  bool away_ = false;
  Book book_;
  Book copy_;
  /// Until the process has connected anew: what it was told by the store before.
  Book before_;
  std::function<void()> reconnected_;
};

}  // namespace uplink::simulation
