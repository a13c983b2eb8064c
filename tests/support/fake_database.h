#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/adopt.h"
#include "storage/batch.h"
#include "storage/claim.h"
#include "storage/commit_record.h"
#include "storage/compare.h"
#include "storage/deliveries.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/latest_kind.h"
#include "storage/leases.h"
#include "storage/open_stream.h"
#include "storage/outcome.h"
#include "storage/reader.h"
#include "storage/retention.h"
#include "storage/robot_hold.h"
#include "storage/samples.h"
#include "storage/store_rules.h"
#include "tests/support/fake_access.h"
#include "tests/support/fake_connections.h"
#include "tests/support/fake_kinds.h"
#include "tests/support/fake_lease_table.h"
#include "tests/support/fake_presence.h"
#include "tests/support/fake_present.h"
#include "tests/support/fake_rejects.h"
#include "tests/support/fake_topics.h"

namespace uplink::testing {

/// One number that a transaction wrote: as a good record, or to quarantine.
struct Application {
  storage::RobotRef robot;
  model::SessionId session;
  model::Seq seq = 0;
  bool quarantined = false;
  storage::Epoch held_since = 0;
  storage::ProcessId process{};
  /// Counts the transactions that were applied, from 1.
  std::uint64_t transaction = 0;
};

/// What was ever written of one session; it outlives the session's eviction.
struct SessionLog {
  /// Good numbers in the order of writing.
  std::vector<model::Seq> stored;
  std::map<model::Seq, model::Rejection> quarantined;
  /// How often each number was written, as either.
  std::map<model::Seq, std::uint32_t> times_written;
};

/// Refuses a good record as the database itself would; nothing lets it pass.
using RefuseRecord =
    std::function<std::optional<model::Rejection>(const storage::CommitRecord& record)>;

/// How a FakeStore treats what it applies.
struct FakeRules {
  RefuseRecord refuse;
  /// A mutation: the cursor follows the last record that was looked at, downwards too. A test that
  /// claims to watch the cursor must fail with it.
  bool allow_cursor_lowering = false;
  /// A mutation: changes of presence are written whatever their number. A test that claims to watch
  /// them must fail with it.
  bool presence_without_cursor = false;
  /// A mutation: changes of presence are written without a look at the holder. A test that claims
  /// to watch holds must fail with it.
  bool presence_without_hold = false;
  /// A mutation: a drone's samples are taken under whatever claim. A test that claims to watch
  /// claims must fail with it.
  bool samples_without_claim = false;
  /// A mutation: a batch makes the row of a robot that has none. A test that claims to watch those
  /// must fail with it.
  bool batches_make_robots = false;
};

/// The durable rows behind FakeStores: what a kill of a process leaves. Several FakeStores share
/// one as processes share a database.
///
/// Thread: thread-safe; each call is one transaction.
class FakeDatabase final {
 public:
  FakeDatabase();
  ~FakeDatabase();
  FakeDatabase(const FakeDatabase&) = delete;
  FakeDatabase& operator=(const FakeDatabase&) = delete;

  // What FakeStore builds on.
  std::vector<storage::OpenResult> OpenStreams(const storage::ProcessId& process,
                                               std::span<const storage::OpenRequest> requests);
  std::vector<storage::AdoptResult> Adopt(const storage::ProcessId& process,
                                          std::span<const storage::AdoptRequest> requests);
  std::vector<storage::ClaimResult> ClaimDrones(const storage::ProcessId& process,
                                                std::span<const storage::ClaimRequest> requests);
  std::vector<storage::Outcome> Commit(const storage::ProcessId& process,
                                       const storage::Batch& batch, const FakeRules& rules,
                                       const storage::StoreRules& store_rules);
  std::size_t Sweep(SystemTime now);
  std::size_t SweepChanges() {
    const std::lock_guard lock(mutex_);
    return kinds_.SweepChanges();
  }
  std::size_t CloseRuns(SystemTime now) {
    const std::lock_guard lock(mutex_);
    return kinds_.CloseRuns(now);
  }
  [[nodiscard]] std::vector<storage::ProcessId> OpenProcesses(
      const storage::ProcessId& self) const {
    const std::lock_guard lock(mutex_);
    return connections_.Processes(self);
  }
  /// No lease of it says when it was renewed.
  std::size_t EndConnections(const storage::ProcessId& process, SystemTime now) {
    const std::lock_guard lock(mutex_);
    return connections_.End(process, now);
  }
  /// Mission runs that commits closed for their bound, since the start.
  [[nodiscard]] std::size_t runs_closed() const {
    const std::lock_guard lock(mutex_);
    return kinds_.runs_closed();
  }
  storage::Trimmed TrimQuarantine(std::span<const std::string> ruris);
  storage::Erased Retain(SystemTime now, const storage::StoreRules& rules);
  std::vector<std::size_t> Checkpoint(const storage::ProcessId& process,
                                      std::span<const storage::LiveRow> rows);

  [[nodiscard]] std::vector<storage::FoundRobot> Compare(
      const storage::ProcessId& process, std::span<const storage::ToldRobot> robots) const;

  // What FakeLeases builds on.
  void Renew(const storage::ProcessId& process, const storage::ProcessCard& card) {
    const std::lock_guard lock(mutex_);
    leases_.Renew(process, card);
  }
  void Release(const storage::ProcessId& process) {
    const std::lock_guard lock(mutex_);
    leases_.Release(process);
  }
  [[nodiscard]] std::vector<storage::Lease> ReadLeases() const {
    const std::lock_guard lock(mutex_);
    return leases_.Read();
  }
  [[nodiscard]] std::vector<storage::ForeignRobot> RobotsOfOthers(const storage::ProcessId& process,
                                                                  std::string_view after) const;

  // What FakeTopicLeases builds on.
  std::optional<storage::Epoch> TakeTopics(const storage::ProcessId& process,
                                           const storage::TakeRequest& request) {
    const std::lock_guard lock(mutex_);
    return topics_.Take(
        request, process,
        [this](const storage::ProcessId& other, std::uint64_t counter) {
          return leases_.RenewedSince(other, counter);
        },
        [this] { return ++epochs_; });
  }
  void ReleaseTopics(const storage::ProcessId& process, std::string_view client_id) {
    const std::lock_guard lock(mutex_);
    topics_.Release(client_id, process);
  }
  [[nodiscard]] std::vector<storage::TopicLease> ReadTopics() const {
    const std::lock_guard lock(mutex_);
    return topics_.Read();
  }
  [[nodiscard]] storage::DeliveryMemory MemoryOfTopics(std::string_view client_id) const {
    const std::lock_guard lock(mutex_);
    return topics_.MemoryOf(client_id);
  }

  // What an operator, or a restored copy, does to the rows.
  /// The robot's row in `robots` goes; all else of it stays.
  void DeleteRobotRow(std::string_view ruri);
  /// The same, and its shapes and objects go with it.
  void RemoveRobot(const std::string& ruri);
  /// As if a statement had changed the shared item.
  void NoteChange(storage::ItemKey key) {
    const std::lock_guard lock(mutex_);
    kinds_.NoteChange(std::move(key));
  }
  /// A mutation: no Reject is kept. A test that claims to watch those that are unconfirmed must
  /// fail with it.
  void ForgetRejects() {
    const std::lock_guard lock(mutex_);
    for (auto& [ruri, robot] : robots_) {
      for (auto& [id, session] : robot.sessions) session.rejects = {};
    }
  }
  /// All rows, leases and sequences become those of another database: of a standby that takes over
  /// without the last commits, or of a copy that is put aside for that.
  void CopyRowsOf(const FakeDatabase& other);
  /// Store::ServerRun: another one after each CopyRowsOf.
  [[nodiscard]] std::string ServerRun() const;
  void EraseLatest(std::string_view ruri, storage::LatestKind kind) {
    const std::lock_guard lock(mutex_);
    kinds_.EraseLatest(std::string(ruri), kind);
  }
  /// A mutation: a robot's epochs count from 1 in each life of its row, as if there were no
  /// sequence. A test that claims to watch holds must fail with it.
  void CountEpochsInEachRow() { epochs_in_each_row_ = true; }
  /// A mutation: a hold counts for its owner whenever it began. A test that claims to watch holds
  /// must fail with it.
  void HoldByOwnerAlone() { holds_by_owner_alone_ = true; }

  /// A mutation: no sample that was stored before a claim is known after it. A test that claims to
  /// watch samples must fail with it.
  void ForgetSamplesAtClaims() { forgets_samples_ = true; }

  // What tests look at.
  /// Nothing while the store does not know the session. Also of storage::kServerRuri.
  [[nodiscard]] std::optional<model::Seq> Cursor(std::string_view ruri,
                                                 const model::SessionId& session) const;
  [[nodiscard]] SessionLog Log(std::string_view ruri, const model::SessionId& session) const;
  /// The sessions that rows were ever written of, by RURI, then session.
  [[nodiscard]] std::vector<std::pair<std::string, model::SessionId>> Sessions() const;
  [[nodiscard]] std::uint32_t TimesWritten(std::string_view ruri, const model::SessionId& session,
                                           model::Seq seq) const;
  /// Why the number lies in quarantine; nothing if it does not.
  [[nodiscard]] std::optional<model::Rejection> QuarantineReason(std::string_view ruri,
                                                                 const model::SessionId& session,
                                                                 model::Seq seq) const;
  /// The applications from number `first` on, counted from 0.
  [[nodiscard]] std::vector<Application> ApplicationsFrom(std::size_t first) const {
    const std::lock_guard lock(mutex_);
    if (first >= applications_.size()) return {};
    return {applications_.begin() + static_cast<std::ptrdiff_t>(first), applications_.end()};
  }
  [[nodiscard]] std::size_t ApplicationCount() const {
    const std::lock_guard lock(mutex_);
    return applications_.size();
  }
  [[nodiscard]] storage::Epoch EpochOf(std::string_view ruri) const;
  /// Since when it is held.
  [[nodiscard]] storage::Epoch HeldSinceOf(std::string_view ruri) const;

 private:
  friend class FakeAccessStore;
  friend class FakeReader;
  friend class FakeSharedItems;

  struct Session {
    model::Seq cursor = 0;
    SystemTime last_used;
    FakeRejects rejects;
    /// Quarantine rows of the session have this entry or a higher one.
    std::uint64_t first_entry = 0;
    /// The highest Hello.settled_seq.
    model::Seq settled = 0;
  };
  using FaultKey = std::pair<std::string, std::string>;
  using GapKey = std::pair<model::SessionId, model::Seq>;
  using GapPlace = std::pair<SystemTime, std::uint64_t>;
  struct Robot {
    model::RobotId id;
    /// 0 while there is no row of it in `robots`.
    storage::Epoch epoch = 0;
    storage::Epoch held_since = 0;
    storage::ProcessId owner{};
    /// Of those who held it since its last OpenStream.
    storage::HolderEnd end = storage::HolderEnd::kEnded;
    SystemTime first_seen;
    SystemTime last_seen;
    /// When its last stream was opened, or its hold was taken for its calls.
    SystemTime last_opened;
    std::optional<storage::RobotHold> claim;
    /// By type.
    std::map<std::uint32_t, storage::SampleMemory> samples;
    std::map<model::SessionId, Session> sessions;
    /// As of the last checkpoint that told it.
    std::optional<storage::SettledSession> settled;
    std::map<model::SessionId, SessionLog> logs;
    std::map<FaultKey, FakeEntry<storage::FaultRow>> faults_active;
    std::map<GapPlace, storage::GapRow> gaps;
    std::map<GapKey, GapPlace> gap_places;
    /// Rows of quarantine_ that still have their payload, oldest first.
    std::deque<std::size_t> payload_rows;
    /// Rows of quarantine_ that went for their bound.
    std::map<model::RejectReason, std::uint64_t> dropped;
  };
  struct Transaction {
    const storage::ProcessId& process;
    const FakeRules& rules;
    const storage::StoreRules& store_rules;
  };

  storage::OpenResult OpenOne(const storage::ProcessId& process,
                              const storage::OpenRequest& request);
  storage::ClaimResult ClaimOne(const storage::ProcessId& process,
                                const storage::ClaimRequest& request);
  /// Whether a claim of the robot takes it as well.
  [[nodiscard]] bool MayHold(const storage::ProcessId& process, const Robot& robot) const;
  static void EvictSessions(Robot& robot, const storage::OpenRequest& request);
  /// Null while there is no row of it in `robots`.
  Robot* FindRobot(std::string_view ruri);
  /// True unless the process holds the robot since exactly then.
  [[nodiscard]] bool IsFenced(const storage::ProcessId& process, const storage::RobotRef& robot,
                              storage::Epoch held_since);
  [[nodiscard]] storage::Epoch DrawEpoch(const Robot& robot);
  storage::Outcome CommitOne(const Transaction& transaction, const storage::CommitRecord& record);
  /// What becomes of all records of the sample; nothing: it is new, and remembered from now on.
  std::optional<storage::OutcomeKind> LookAtSample(const Transaction& transaction,
                                                   const storage::CommitRecord& record);
  /// A record that is new; `session` is null for one of a sample.
  storage::Outcome WriteNew(const Transaction& transaction, Robot& robot, Session* session,
                            const storage::CommitRecord& record);
  std::optional<model::Rejection> Refusal(const Transaction& transaction, const Robot& robot,
                                          const storage::CommitRecord& record) const;
  void WriteRecord(const Transaction& transaction, Robot& robot,
                   const storage::CommitRecord& record);
  /// What is there of the robot goes with it to another fleet.
  void MoveItems(Robot& robot, const model::RobotId& to);
  void WriteFault(Robot& robot, const model::Fault& fault, const storage::CommitRecord& record);
  void WriteQuarantine(Robot& robot, Session* session, const storage::CommitRecord& record,
                       const model::Rejection& rejection);
  Session& SessionOf(Robot& robot, const model::SessionId& session) const {
    const auto [found, is_new] = robot.sessions.try_emplace(session);
    if (is_new) found->second.first_entry = entries_ + 1;
    return found->second;
  }
  void EraseQuarantine(SystemTime until, storage::Erased& erased);
  /// Deletes those of `gone` (entries), and counts payloads anew. Returns how many Rejects of them
  /// are kept.
  std::size_t EraseQuarantineRows(const std::set<std::uint64_t>& gone);
  std::size_t EraseGaps(SystemTime until);
  void WriteGap(const storage::ProcessId& process, const storage::GapItem& gap);
  [[nodiscard]] const SessionLog* FindLog(std::string_view ruri,
                                          const model::SessionId& session) const;

  mutable std::mutex mutex_;
  std::map<std::string, Robot, std::less<>> robots_;
  std::vector<FakeEntry<storage::FaultRow>> faults_history_;
  std::vector<FakeEntry<storage::QuarantineRow>> quarantine_;
  FakeKinds kinds_;
  FakePresence presence_;
  FakeConnections connections_;
  FakeAccess access_;
  std::map<std::string, storage::LiveRow, std::less<>> live_;
  FakeLeaseTable leases_;
  FakeTopics topics_;
  std::vector<Application> applications_;
  std::uint64_t entries_ = 0;
  std::uint64_t transactions_ = 0;
  storage::Epoch epochs_ = 0;
  bool epochs_in_each_row_ = false;
  std::uint64_t server_runs_ = 1;
  bool holds_by_owner_alone_ = false;
  bool forgets_samples_ = false;
};

}  // namespace uplink::testing
