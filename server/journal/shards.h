#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "server/journal/journal.h"

namespace uplink::journal {

/// The journals of a server, one per writing connection. A robot is always in the same one, so its
/// order is kept. Each has its share of the bounds.
///
/// Thread: thread-safe. The journals must outlive it.
class Shards final {
 public:
  /// At least one journal; the first has the duties (JournalLimits).
  explicit Shards(std::vector<Journal*> journals);

  [[nodiscard]] Journal& Of(std::string_view ruri) const;
  [[nodiscard]] const std::vector<Journal*>& all() const { return journals_; }

  // As Journal's, in the robot's journal.
  void NotePresence(const storage::RobotRef& robot, model::Presence presence, SystemTime at,
                    std::optional<model::ConnectionEnd> why = {},
                    std::optional<SystemTime> parked_until = {}) const {
    Of(robot->ruri).NotePresence(robot, presence, at, why, parked_until);
  }
  void NoteConnection(storage::ConnectionItem item) const {
    Journal& journal = Of(item.robot->ruri);
    journal.NoteConnection(std::move(item));
  }
  void Adopt(AdoptEntry entry) const {
    Journal& journal = Of(entry.request.robot->ruri);
    journal.Adopt(std::move(entry));
  }
  void Lose(LossEntry entry) const {
    Journal& journal = Of(entry.robot->ruri);
    journal.Lose(std::move(entry));
  }
  void Leave(LeaveEntry entry) const {
    Journal& journal = Of(entry.robot->ruri);
    journal.Leave(std::move(entry));
  }

  /// As Journal's, in all journals.
  void RequestCheckpoint() const {
    for (Journal* journal : journals_) journal->RequestCheckpoint();
  }

  // Over all journals.
  [[nodiscard]] std::size_t records() const;
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] milliseconds oldest(SteadyTime now) const;
  /// For the fullest journal.
  [[nodiscard]] std::size_t records_worst() const;
  [[nodiscard]] std::size_t bytes_worst() const;
  [[nodiscard]] bool idle() const;
  /// The first journal's last error, with its shard if there are several; OK if none has one.
  [[nodiscard]] absl::Status last_error() const;
  /// The error of the first journal that cannot write checkpoints; OK if all can.
  [[nodiscard]] absl::Status checkpoint_error() const;
  /// As Journal's, of each journal that found any, with its shard.
  [[nodiscard]] std::vector<WentBack> TakeWentBack() const;
  /// For the journal that keeps the histories.
  [[nodiscard]] absl::Status retain_error() const { return journals_.front()->retain_error(); }

 private:
  const std::vector<Journal*> journals_;
};

/// The limits of each of `shards` journals: together they keep `all`.
[[nodiscard]] JournalLimits ShareOf(const JournalLimits& all, std::size_t shards);

/// The numbering of a shard's changes of presence: one per process and shard.
[[nodiscard]] storage::ProcessId PresenceSessionOf(const storage::ProcessId& process,
                                                   std::size_t shard);

}  // namespace uplink::journal
