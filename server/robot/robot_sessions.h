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
#include "server/robot/fleet_words.h"
#include "server/robot/held_back.h"
#include "server/robot/limits.h"
#include "server/robot/numbering.h"
#include "server/robot/opening.h"
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

/// What is known of a stream that wants the robot.
struct Newcomer {
  /// Of its Arrive.
  std::optional<std::uint64_t> number = {};
  /// Through which gateway it came; empty: the robot speaks by itself.
  std::string gateway = {};
};

/// The sessions of one robot in memory, behind one mutex: the SessionTable (numbers and Rejects of
/// each session), the Reconnects (how often streams come), the Takeover (which stream is the
/// robot's), the store's Opening and the Pacing.
/// Outlives streams, and learns of commits through its Robot.
///
/// Thread: thread-safe by one mutex, never held across a call out. What only the robot's stream
/// may call says so.
class RobotSessions final {
 public:
  /// A broker's reader counts its robots' messages itself, since each may be several records; those
  /// of the relay are counted here.
  explicit RobotSessions(model::MessageSource source = model::MessageSource::kUplink)
      : source_(source) {}

  [[nodiscard]] model::MessageSource source() const { return source_; }

  // --- Streams (any stream of the robot) ---

  /// A stream came with a valid Hello: as Reconnects::Arrive. What it says the stream does, before
  /// it Attaches.
  [[nodiscard]] std::optional<Reconnects::Arrival> Arrive(SteadyTime now,
                                                          const ReconnectLimits& limits);
  /// A stream that Arrive made wait does so no more.
  void EndWait() {
    const std::lock_guard lock(mutex_);
    reconnects_.EndWait();
  }
  using Attached = Takeover::Attached;
  /// A new stream wants the robot. An older one is superseded and must confirm by Detach first. It
  /// is superseded itself if a stream wanted the robot that came later than its number; without a
  /// number none did.
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
  /// The robot's stream is to end. Returns it, to be woken; none if there is none.
  loop::StreamRef EndStream() {
    const std::lock_guard lock(mutex_);
    takeover_.End();
    return takeover_.current();
  }

  // --- The robot's stream ---

  struct Begun {
    /// The id under which OpenStream is to be asked for.
    std::uint64_t open_id = 0;
    /// Goes with every record of the stream (Journal::Append).
    std::uint64_t generation = 0;
    /// What OpenStream is to be told: a word that moves a robot stands until the store was told.
    storage::FleetWord fleet_word = storage::FleetWord::kMoves;
    /// Messages that waited for an earlier stream's word for another fleet, which the store has not
    /// judged and never will: they are void, to be counted superseded.
    std::optional<std::size_t> disowned = {};
  };
  /// Opens the session on the robot's stream, which says so of the robot's fleet; creates it,
  /// forgetting the least recently used idle one over kSessionsMax. Nothing if all sessions wait
  /// for commits.
  [[nodiscard]] std::optional<Begun> Begin(const model::SessionId& session, SteadyTime now,
                                           const FleetSaid& said = {});
  /// Sessions in memory, for OpenRequest.sessions_held.
  [[nodiscard]] std::vector<model::SessionId> Held() const {
    const std::lock_guard lock(mutex_);
    return sessions_.Ids();
  }
  /// True once the store has answered OpenStream `open_id`.
  [[nodiscard]] bool Opened(std::uint64_t open_id) const {
    const std::lock_guard lock(mutex_);
    return opening_.answered(open_id);
  }
  /// What Welcome says, from what is known now: session memory, and the store's answer if it is
  /// here.
  [[nodiscard]] Resume ResumeFrom(const model::SessionId& session, std::uint64_t open_id,
                                  model::Seq settled_seq, model::Seq judged_seq);

  /// Sees one number: a duplicate, new, or of a session that was forgotten.
  [[nodiscard]] Seen See(const model::SessionId& session, model::Seq seq);
  /// The session was not forgotten: this process still has the robot.
  [[nodiscard]] bool Knows(const model::SessionId& session) const {
    const std::lock_guard lock(mutex_);
    return sessions_.Find(session) != nullptr;
  }
  /// The number just seen is settled at once.
  void AddSettled(const model::SessionId& session, model::Seq seq);
  /// The number just seen waits for its commit, and costs the journal `bytes`. Returns by how much
  /// the window's own count grew: 0 if the session was forgotten meanwhile.
  [[nodiscard]] std::int64_t AddWaiting(const model::SessionId& session, model::Seq seq,
                                        std::size_t bytes = 0);
  /// A rejection made at judgement, remembered for the next Welcome.
  void Remember(const model::SessionId& session, RejectedSeq rejected);
  /// The same of a live message that was over its rate.
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

  /// Takes the state for an Ack, and the store's Rejects that were not told yet, in one look.
  [[nodiscard]] Progress Take(const model::SessionId& session);
  /// A good message of a kind of which the latest is kept was handed to the journal.
  void AddLatest(const model::SessionId& session, model::Seq seq, storage::LatestKind kind) {
    const std::lock_guard lock(mutex_);
    // The store has settled it already, so that it brings the store nothing.
    if (free_through_.load() != kNotKnown && seq <= free_through_.load()) return;
    resends_.AddGood(kind, {session, seq});
  }
  /// What the store lacks of the robot, as far as it has said so to this stream.
  [[nodiscard]] ResendView resend_view() const { return resends_.view(); }
  /// As Resends::Take.
  [[nodiscard]] Resends::Due TakeResends(SteadyTime now) {
    const std::lock_guard lock(mutex_);
    return resends_.Take(now);
  }
  /// Why the stream is not read now; kNone once it is, or ends. For View alone.
  void SetHeldBack(HeldBack by, SystemTime now) {
    const std::lock_guard lock(mutex_);
    held_back_.Set(by, now);
  }
  /// Messages and gap records of the robot that are not committed.
  [[nodiscard]] std::size_t in_flight() const { return in_flight_.load() + gaps_in_flight_.load(); }
  /// What of the robot waits in the journal.
  [[nodiscard]] JournalUse journal_use() const {
    const std::size_t gaps = gaps_in_flight_.load();
    return {in_flight_.load() + gaps, record_bytes_.load() + gaps * kRecordOverheadBytes};
  }
  /// What the stream's session sends again was decided before up to here, as far as the store has
  /// said so: it costs no tokens. Until the store has answered, nothing does.
  [[nodiscard]] model::Seq free_through() const { return free_through_.load(); }
  /// Rejects of the stream's session that its agent has not said to have processed, as far as this
  /// process knows: the store tells of earlier ones if it answers before Welcome.
  [[nodiscard]] std::size_t unconfirmed() const { return unconfirmed_.load(); }
  /// Rejects of the session that its stream is to be told, and that are to be read first; nothing
  /// if none are.
  [[nodiscard]] std::optional<UnreadRejects> UnreadOf(const model::SessionId& session) const;
  /// They were read up to `through`; Take has them now.
  void AddPage(const model::SessionId& session, std::vector<storage::StoredReject> page,
               model::Seq through);
  /// There may be Rejects of the session that its stream was not told, since they are to be read,
  /// or since the store did not answer before the Welcome (it wakes the stream when it does): no
  /// Ack covers them until then.
  [[nodiscard]] bool AwaitsRejects(const model::SessionId& session) const;
  /// Of this session alone.
  [[nodiscard]] std::size_t waiting(const model::SessionId& session) const;

  // --- Views and the sweep ---

  [[nodiscard]] SessionView View() const;
  /// What the store has of the robot's last session: View shows it while memory has none, as far
  /// as any call said. It begins no session and numbers nothing.
  void Restore(const storage::SettledSession& last);
  /// The robot's session and how far it is settled, if that is news since the last call: for a
  /// checkpoint. Nothing while there is none.
  [[nodiscard]] std::optional<storage::SettledSession> TakeSettled();
  /// What was taken could not be kept: it is news again.
  void PutBackSettled();
  /// Forgets sessions that had no stream for `idle` and wait for nothing. View goes on to show the
  /// last one.
  void Sweep(SteadyTime now, milliseconds idle);

  // --- What the journal tells, as CommitClient has it ---

  [[nodiscard]] bool HasStream() const;
  loop::StreamRef OnOpened(std::uint64_t open_id, const storage::OpenResult& result);
  /// Nothing if another stream was opened since. The stream is to be woken.
  std::optional<FleetWords::Refused> OnOtherFleet(std::uint64_t open_id, metrics::Ledger& ledger);
  loop::StreamRef OnSettled(std::span<const Settled> settled, metrics::Ledger& ledger);
  loop::StreamRef OnGapsWritten(std::size_t count);
  loop::StreamRef OnFenced(metrics::Ledger& ledger) {
    return VoidAndStop(Standing::kSuperseded, ledger);
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
  /// All that waits is void, and the stream must stop. Returns it.
  loop::StreamRef VoidAndStop(Standing standing, metrics::Ledger& ledger);
  /// All that waits is void. Returns how much it was. Under the lock.
  std::size_t Void();
  /// Of the current session, after it was given Rejects; also whether some are to be read. Under
  /// the lock.
  void CountUnconfirmed();

  const model::MessageSource source_;
  mutable std::mutex mutex_;
  SessionTable sessions_;
  Reconnects reconnects_;
  Takeover takeover_;
  Opening opening_;
  Pacing pacing_;
  Resends resends_;
  /// The session of the robot's stream, or of its last one.
  std::optional<model::SessionId> current_session_;
  std::optional<storage::SettledSession> settled_taken_;
  HeldBackTrack held_back_;
  FleetWords fleet_words_;
  /// For View alone, while the current session is not held.
  std::optional<storage::SettledSession> last_session_;
  std::atomic<std::size_t> in_flight_{0};
  std::atomic<std::size_t> gaps_in_flight_{0};
  /// Of messages that are not committed; changed under the lock alone.
  std::atomic<std::size_t> record_bytes_{0};
  std::atomic<std::size_t> unconfirmed_{0};
  std::atomic<model::Seq> free_through_{kNotKnown};
  /// Spares a stream the lock where nothing is to be read.
  std::atomic<bool> has_unread_{false};
  std::atomic<std::uint64_t> generation_{1};
};

}  // namespace uplink::robot
