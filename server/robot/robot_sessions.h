#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "schema/model/message_source.h"
#include "schema/model/rejection.h"
#include "server/loop/wake.h"
#include "server/robot/commit_client.h"
#include "server/robot/fleet_claims.h"
#include "server/robot/held_back.h"
#include "server/robot/limits.h"
#include "server/robot/numbering.h"
#include "server/robot/open_answer.h"
#include "server/robot/pacing.h"
#include "server/robot/progress.h"
#include "server/robot/reconnects.h"
#include "server/robot/rejected_seq.h"
#include "server/robot/resends.h"
#include "server/robot/session_table.h"
#include "server/robot/session_view.h"
#include "server/robot/takeover.h"
#include "storage/latest_kind.h"
#include "storage/live_row.h"

namespace uplink::robot {

/// A stream that wants the robot.
struct Newcomer {
  /// The number of its Arrive.
  std::optional<std::uint64_t> number = {};
  /// The gateway through which it came; empty: the robot speaks by itself.
  std::string gateway = {};
};

/// The sessions of one robot in memory, behind one mutex: the SessionTable (numbers and Rejects of
/// each session), the Reconnects (how often streams come), the Takeover (which stream is the
/// robot's), the store's OpenAnswer and the Pacing. It outlives streams, and learns of commits
/// through its Robot.
///
/// Thread: thread-safe by one mutex, never held across a call out. Functions for the robot's stream
///         alone say so.
class RobotSessions final {
 public:
  /// Messages of the relay are counted here. A broker's reader counts its own, since each may be
  /// several records.
  explicit RobotSessions(model::MessageSource source = model::MessageSource::kUplink)
      : source_(source) {}

  [[nodiscard]] model::MessageSource source() const { return source_; }

  // --- Streams (any stream of the robot) ---

  /// A stream came with a valid Hello: as Reconnects::Arrive. The stream waits as that says, then
  /// Attaches.
  [[nodiscard]] std::optional<Reconnects::Arrival> Arrive(SteadyTime now,
                                                          const ReconnectLimits& limits);
  /// A stream that Arrive delayed no longer waits.
  void EndWait() {
    const std::lock_guard lock(mutex_);
    reconnects_.EndWait();
  }
  using Attached = Takeover::Attached;
  /// A new stream wants the robot. It supersedes an older one, which must confirm by Detach first.
  /// It is superseded itself if a stream with a later number has wanted the robot.
  [[nodiscard]] Attached Attach(loop::StreamRef stream, SteadyTime now, SystemTime system_now,
                                Newcomer comer = {});
  [[nodiscard]] Standing StandingOf(loop::StreamRef stream) const {
    const std::lock_guard lock(mutex_);
    return takeover_.StandingOf(stream);
  }
  /// The stream takes no more frames (its own thread says so). Returns the stream that is next.
  loop::StreamRef Detach(loop::StreamRef stream, SteadyTime now);
  /// The robot's stream; none if there is none.
  [[nodiscard]] loop::StreamRef stream() const {
    const std::lock_guard lock(mutex_);
    return takeover_.current();
  }
  /// Ends the robot's stream, as Takeover::End. Returns it, to be woken; none if there is none.
  loop::StreamRef EndStream(Standing standing = Standing::kEnded) {
    const std::lock_guard lock(mutex_);
    takeover_.End(standing);
    return takeover_.current();
  }

  // --- The robot's stream ---

  struct Begun {
    /// The id for OpenStream.
    std::uint64_t open_id = 0;
    /// Goes with every record of the stream (Journal::Append).
    std::uint64_t generation = 0;
    /// The claim for OpenStream: one that moves a robot holds until the store has answered it.
    storage::FleetWord fleet_word = storage::FleetWord::kMoves;
    /// Messages that waited for an earlier stream's claim of another fleet, which the store will
    /// never judge. They are void; the caller counts them superseded.
    std::optional<std::size_t> disowned = {};
  };
  /// Opens the session on the robot's stream, with its claim about the fleet. Creates it if it is
  /// not in memory, and then forgets the least recently used idle one over kSessionsMax. Empty if
  /// all sessions wait for commits.
  [[nodiscard]] std::optional<Begun> Begin(const model::SessionId& session, SteadyTime now,
                                           const FleetClaim& claim = {});
  /// Sessions in memory, for OpenRequest.sessions_held.
  [[nodiscard]] std::vector<model::SessionId> Held() const {
    const std::lock_guard lock(mutex_);
    return sessions_.Ids();
  }
  /// True once the store has answered OpenStream `open_id`.
  [[nodiscard]] bool Opened(std::uint64_t open_id) const {
    const std::lock_guard lock(mutex_);
    return open_answer_.answered(open_id);
  }
  /// The contents of Welcome, from session memory and, if it has come, the store's answer.
  [[nodiscard]] Resume ResumeFrom(const model::SessionId& session, std::uint64_t open_id,
                                  model::Seq settled_seq, model::Seq judged_seq);

  /// Looks at one number: a duplicate, new, or of a forgotten session.
  [[nodiscard]] Seen See(const model::SessionId& session, model::Seq seq);
  /// The session was not forgotten, so this process still has the robot.
  [[nodiscard]] bool Knows(const model::SessionId& session) const {
    const std::lock_guard lock(mutex_);
    return sessions_.Find(session) != nullptr;
  }
  /// The number just seen is settled at once.
  void AddSettled(const model::SessionId& session, model::Seq seq);
  /// The number just seen waits for its commit, and takes `bytes` of the journal. Returns by how
  /// much the window grew: 0 if the session was forgotten meanwhile.
  [[nodiscard]] std::int64_t AddWaiting(const model::SessionId& session, model::Seq seq,
                                        std::size_t bytes = 0);
  /// Remembers a rejection by judgement for the next Welcome.
  void Remember(const model::SessionId& session, RejectedSeq rejected);
  /// The same for a live message over its rate.
  void RememberLive(const model::SessionId& session, RejectedSeq limited) {
    const std::lock_guard lock(mutex_);
    SessionMemory* memory = sessions_.Find(session);
    if (memory != nullptr) memory->rejects.RememberLive(std::move(limited));
  }
  /// The gap before the number just seen goes to the journal.
  void AddGap(const model::SessionId& session, const Seen& seen) {
    gaps_in_flight_.fetch_add(1);
    const std::lock_guard lock(mutex_);
    if (SessionMemory* memory = sessions_.Find(session)) memory->numbers.AddMissing(seen.missing);
  }
  /// Whether the payload of a rejection for this reason is kept now (Pacing).
  [[nodiscard]] bool KeepPayload(model::RejectReason reason, SteadyTime now) {
    const std::lock_guard lock(mutex_);
    return pacing_.KeepPayload(reason, now);
  }
  /// Whether a Notice of this field may be sent now (Pacing).
  [[nodiscard]] bool MayNotice(const std::string& field, SteadyTime now) {
    const std::lock_guard lock(mutex_);
    return pacing_.MayNotice(field, now);
  }

  /// Takes the progress for an Ack, and the store's Rejects that were not told yet, under one lock.
  [[nodiscard]] Progress Take(const model::SessionId& session);
  /// A good message of a kind whose latest is kept was given to the journal.
  void AddLatest(const model::SessionId& session, model::Seq seq, storage::LatestKind kind) {
    const std::lock_guard lock(mutex_);
    // The store has settled it already, so it is nothing new.
    if (free_through_.load() != kNotKnown && seq <= free_through_.load()) return;
    resends_.AddGood(kind, {session, seq});
  }
  /// The messages that the store lacks, by its answer to this stream.
  [[nodiscard]] ResendView resend_view() const { return resends_.view(); }
  /// As Resends::Take.
  [[nodiscard]] Resends::Due TakeResends(SteadyTime now) {
    const std::lock_guard lock(mutex_);
    return resends_.Take(now);
  }
  /// Why the stream is not read now; kNone once it is, or it ends. For View alone.
  void SetHeldBack(HeldBack by, SystemTime now) {
    const std::lock_guard lock(mutex_);
    held_back_.Set(by, now);
  }
  [[nodiscard]] HeldBack held_back() const {
    const std::lock_guard lock(mutex_);
    return held_back_.by();
  }
  /// Messages and gap records of the robot that are not committed.
  [[nodiscard]] std::size_t in_flight() const { return in_flight_.load() + gaps_in_flight_.load(); }
  /// The robot's records and gaps in the journal.
  [[nodiscard]] JournalUse journal_use() const {
    const std::size_t gaps = gaps_in_flight_.load();
    return {in_flight_.load() + gaps, record_bytes_.load() + gaps * kRecordOverheadBytes};
  }
  /// The store's cursor at its answer to this stream: messages up to it were decided before, and
  /// cost no tokens if sent again. kNotKnown before the answer, so that nothing costs any.
  [[nodiscard]] model::Seq free_through() const { return free_through_.load(); }
  /// Rejects of the stream's session that its agent has not confirmed, of those that this process
  /// knows. It learns earlier ones from the store's answer.
  [[nodiscard]] std::size_t unconfirmed() const { return unconfirmed_.load(); }
  /// The Rejects of the session that must be read for its stream; empty if there are none.
  [[nodiscard]] std::optional<UnreadRejects> UnreadOf(const model::SessionId& session) const;
  /// A page up to `through` was read; Take returns it.
  void AddPage(const model::SessionId& session, std::vector<storage::StoredReject> page,
               model::Seq through);
  /// The stream may lack Rejects of the session, because they must be read, or because the store
  /// did not answer before the Welcome (it wakes the stream when it does). No Ack covers them until
  /// then.
  [[nodiscard]] bool AwaitsRejects(const model::SessionId& session) const;
  /// Waiting messages of this session alone.
  [[nodiscard]] std::size_t waiting(const model::SessionId& session) const;

  // --- Views and the sweep ---

  [[nodiscard]] SessionView View() const;
  /// The store's state of the robot's last session, which View shows while memory has none. It
  /// begins no session and numbers nothing.
  void Restore(const storage::SettledSession& last);
  /// The robot's session and how far it is settled, for a checkpoint, if that is news since the
  /// last call; empty otherwise.
  [[nodiscard]] std::optional<storage::SettledSession> TakeSettled();
  /// The taken value could not be stored: it is news again.
  void PutBackSettled();
  /// Forgets sessions that had no stream for `idle` and wait for nothing. View still shows the last
  /// one.
  void Sweep(SteadyTime now, milliseconds idle);

  // --- What the journal tells, as CommitClient has it ---

  [[nodiscard]] bool HasStream() const;
  loop::StreamRef OnOpened(std::uint64_t open_id, const storage::OpenResult& result);
  /// Empty if another stream was opened since. Otherwise wake the stream.
  std::optional<FleetClaims::Refused> OnOtherFleet(std::uint64_t open_id, metrics::Ledger& ledger);
  loop::StreamRef OnSettled(std::span<const Settled> settled, metrics::Ledger& ledger);
  loop::StreamRef OnGapsWritten(std::size_t count);
  loop::StreamRef OnFenced(metrics::Ledger& ledger) {
    return VoidAndStop(Standing::kSuperseded, ledger);
  }
  loop::StreamRef OnRefused(metrics::Ledger& ledger) {
    return VoidAndStop(Standing::kNotRegistered, ledger);
  }
  [[nodiscard]] std::vector<storage::CommittedSession> Committed() const {
    const std::lock_guard lock(mutex_);
    return sessions_.Committed();
  }
  loop::StreamRef OnWentBack(metrics::Ledger& ledger) {
    return VoidAndStop(Standing::kWentBack, ledger);
  }
  [[nodiscard]] std::uint64_t generation() const { return generation_.load(); }

 private:
  static constexpr model::Seq kNotKnown = std::numeric_limits<model::Seq>::max();

  /// The session of the robot's stream, or of its last one; null if it is not held. Under the lock.
  [[nodiscard]] const SessionMemory* CurrentSession() const;
  /// Counts messages of the relay.
  void Publish(const metrics::MessageCounts& counts, metrics::Ledger& ledger) const {
    if (source_ == model::MessageSource::kUplink) ledger.Publish(counts);
  }
  /// Makes everything that waits void, and stops the stream. Returns it.
  loop::StreamRef VoidAndStop(Standing standing, metrics::Ledger& ledger);
  /// Makes everything that waits void. Returns how many messages that were. Under the lock.
  std::size_t Void();
  /// Updates the counts of the current session after it got Rejects, and whether some must be read.
  /// Under the lock.
  void CountUnconfirmed();

  const model::MessageSource source_;
  mutable std::mutex mutex_;
  SessionTable sessions_;
  Reconnects reconnects_;
  Takeover takeover_;
  OpenAnswer open_answer_;
  Pacing pacing_;
  Resends resends_;
  /// The session of the robot's stream, or of its last one.
  std::optional<model::SessionId> current_session_;
  std::optional<storage::SettledSession> settled_taken_;
  HeldBackTrack held_back_;
  FleetClaims fleet_claims_;
  /// For View alone, while the current session is not in memory.
  std::optional<storage::SettledSession> last_session_;
  std::atomic<std::size_t> in_flight_{0};
  std::atomic<std::size_t> gaps_in_flight_{0};
  /// Bytes of messages that are not committed; changed under the lock only.
  std::atomic<std::size_t> record_bytes_{0};
  std::atomic<std::size_t> unconfirmed_{0};
  std::atomic<model::Seq> free_through_{kNotKnown};
  /// Spares a stream the lock while nothing must be read.
  std::atomic<bool> has_unread_{false};
  std::atomic<std::uint64_t> generation_{1};
};

}  // namespace uplink::robot
