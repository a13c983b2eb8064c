#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/batch.h"
#include "storage/commit_record.h"
#include "storage/deliveries.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/outcome.h"
#include "storage/presence.h"
#include "storage/present.h"
#include "storage/remember.h"
#include "storage/samples.h"
#include "storage/store_rules.h"

// What a store decides for the records of a batch (Store::Commit), once for every store.
namespace uplink::storage {

/// A robot that has a row, as the batch at hand has it so far.
struct KnownRobot {
  /// Ids of requests to its operator.
  using RequestIds = std::set<std::string, std::less<>>;

  /// The epoch since which the process that commits holds it; nothing: another process does.
  std::optional<Epoch> held_since;
  /// The epoch of that process's claim on the drone; nothing: it has none.
  std::optional<Epoch> claim;
  /// Entries that are present, by PresentKind, expired ones included. Nothing: not counted yet;
  /// that is done when the first new entry asks.
  std::array<std::optional<std::size_t>, kPresentKinds> counts;
  /// Those that are open. Nothing: not read yet; that is done when the first request asks.
  std::optional<RequestIds> open_requests;
};

/// What is remembered of a drone's samples of one type, as the batch at hand has it so far.
struct KnownSamples {
  SampleMemory memory;
  /// Whether the batch added to it, and the latest arrival of what did.
  bool is_changed = false;
  SystemTime stored_at;
};

/// A session, as the batch at hand has it so far.
struct KnownSession {
  model::Seq cursor = 0;
  /// Whether the batch raised the cursor, and the latest arrival of what did.
  bool is_raised = false;
  SystemTime last_used;
};

/// What a store knows of the robots of a batch and a decision asks for. Each answer includes what
/// was decided before in the same batch: a store writes a record, or notes it, before the
/// next one is decided.
///
/// Errors: the store's own; they end the batch.
class Known {
 public:
  Known() = default;
  Known(const Known&) = delete;
  Known& operator=(const Known&) = delete;
  virtual ~Known() = default;

  /// Null if the store has no row of the robot. The answer is valid for the whole batch.
  [[nodiscard]] virtual absl::StatusOr<KnownRobot*> Robot(std::string_view ruri) = 0;
  /// Of a record whose robot was asked for, and is known. The answer is valid until the next call.
  [[nodiscard]] virtual absl::StatusOr<KnownSession*> Session(const CommitRecord& record) = 0;
  /// Why the record's number was rejected (in quarantine, or kept); nothing if it was not.
  [[nodiscard]] virtual absl::StatusOr<std::optional<model::Rejection>> Rejected(
      const CommitRecord& record) = 0;

  /// Of a record's sample, whose robot was asked for, and is known. The answer is valid until the
  /// next call.
  [[nodiscard]] virtual absl::StatusOr<KnownSamples*> Samples(const CommitRecord& record) = 0;
  /// A robot's requests to its operator that are open.
  [[nodiscard]] virtual absl::StatusOr<KnownRobot::RequestIds> OpenRequests(
      std::string_view ruri) = 0;

  /// The epoch of the client id's lease on topics, which stays ours until the batch ends; 0: this
  /// process has none.
  [[nodiscard]] virtual absl::StatusOr<Epoch> LeaseEpoch(std::string_view client_id) = 0;

  /// When the entry expires, 0: never; nothing if there is none.
  [[nodiscard]] virtual absl::StatusOr<std::optional<std::int64_t>> ExpiryOf(
      const PresentKey& key) = 0;
  /// A robot's entries, expired ones included.
  [[nodiscard]] virtual absl::StatusOr<std::size_t> Count(PresentKind kind,
                                                          std::string_view ruri) = 0;
  /// Deletes an entry that has expired, so that the upsert at hand makes a new one.
  [[nodiscard]] virtual absl::Status Delete(const PresentKey& key) = 0;
  /// Deletes all entries of a robot that have expired by `now_ms`; returns how many. Of kinds that
  /// expire alone.
  [[nodiscard]] virtual absl::StatusOr<std::size_t> DeleteExpired(PresentKind kind,
                                                                  std::string_view ruri,
                                                                  std::int64_t now_ms) = 0;
};

/// True if the number is above the session's cursor, which it then becomes.
[[nodiscard]] bool RaiseCursor(KnownSession& session, model::Seq number, SystemTime at);

/// What the bounds say to a new record.
struct Ruling {
  /// Set if a bound refuses the record: it goes to quarantine.
  std::optional<model::Rejection> refusal;
  /// What the record changes of what is present, if anything.
  std::optional<PresentChange> change;
  /// Whether there was such an entry before.
  bool was_present = false;
};

/// Decides the records of one batch, one after the other. The caller does what was decided before
/// it asks for the next:
///
/// 1. Look: the record is fenced, or was there before: that is its outcome, and nothing is written.
///    A robot that the store does not know has no holder, so its records are fenced. So is what
///    came under a lease that another took. Records of a sample are decided by its mark, once for
///    all of them; the memory of its type takes it in then.
/// 2. Otherwise it is new, and the session's cursor is its number now. A QuarantineItem goes to
///    quarantine, a LimitedRange to the kept Rejects, and is stored.
/// 3. A good record is held against the bounds (Judge). It is written, or its rejection goes to
///    quarantine in its stead and it is refused.
///
/// Errors: those of Known.
/// Thread: confined to that of its store.
class Decider final {
 public:
  /// Both must outlive this.
  Decider(Known& known, const StoreRules& rules) : known_(known), rules_(rules) {}

  /// The outcome of a record that is not new; nothing for one that is.
  [[nodiscard]] absl::StatusOr<std::optional<Outcome>> Look(const CommitRecord& record);
  /// For a slice of a batch that may begin within a sample: `before` is the record in front of the
  /// slice, which another Decider decided, and `outcome` its outcome.
  void ResumeSample(const CommitRecord& before, const Outcome& outcome);
  /// Of a good record that Look found new. What it lets pass counts from now on.
  [[nodiscard]] absl::StatusOr<Ruling> Judge(const CommitRecord& record);
  /// What becomes of the batch's deliveries, once `outcomes` has those of its records.
  [[nodiscard]] absl::StatusOr<DeliveryChanges> Remember(const Batch& batch,
                                                         std::span<const Outcome> outcomes);
  /// Whether to write the gap: false if it is fenced.
  [[nodiscard]] absl::StatusOr<bool> Takes(const GapItem& gap);
  /// What becomes of a change of presence: the caller writes kStored ones. `session` numbers it.
  [[nodiscard]] absl::StatusOr<OutcomeKind> Decide(const PresenceItem& item, KnownSession& session);

 private:
  /// Nothing: the sample is new, and is remembered from now on.
  absl::StatusOr<std::optional<OutcomeKind>> LookAt(const CommitRecord& of_sample);
  absl::StatusOr<Ruling> JudgeRequest(const CommitRecord& record,
                                      const model::OperatorRequest& request);
  /// True if the client id's lease is not this one any more. False without one (null).
  absl::StatusOr<bool> IsLeaseOver(const TopicHold* hold);
  /// True unless this process holds the robot since exactly then: a store that went back gives an
  /// epoch twice, so a greater one proves nothing.
  absl::StatusOr<bool> IsFenced(const RobotRef& robot, Epoch held_since);
  /// True if there is room for an upsert of the entry; it is counted then. `there` is when the
  /// entry that is there expires.
  absl::StatusOr<bool> MakeRoom(const PresentChange& change, KnownRobot& robot,
                                const std::optional<std::int64_t>& there, SystemTime now);

  Known& known_;
  const StoreRules& rules_;
  /// The sample of the record that was looked at last, and what became of it (LookAt).
  const SampleMark* sample_ = nullptr;
  std::optional<OutcomeKind> sample_outcome_;
};

}  // namespace uplink::storage
