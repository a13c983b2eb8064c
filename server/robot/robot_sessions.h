#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "schema/model/rejection.h"
#include "server/robot/ack_window.h"
#include "server/robot/commit_client.h"
#include "server/robot/limits.h"
#include "server/robot/wake.h"

namespace uplink::robot {

/// A number that was rejected, as the agent is told.
struct RejectedSeq {
  model::Seq seq = 0;
  model::Rejection rejection;
};

/// How far a session is, for an Ack, with the Rejects that must be written before it.
struct Progress {
  model::Seq through = 0;
  model::Seq judged = 0;
  std::vector<RejectedSeq> rejects;
  /// Arrivals of the durable messages that commits released since the last look, for ack latency.
  std::vector<SteadyTime> released;
};

/// Where a stream stands among the robot's streams.
enum class StreamPlace : std::uint8_t {
  /// It is the robot's stream.
  kCurrent,
  /// It waits until the older stream has confirmed its end.
  kWaiting,
  /// A newer stream took over, or another process holds the robot: it must stop and Detach.
  kSuperseded,
};

/// What a stream learns when it starts on a session.
struct Resume {
  /// Welcome.committed_seq.
  model::Seq committed = 0;
  /// Rejects above Hello.settled_seq, ascending, to be told once more.
  std::vector<RejectedSeq> rejects;
};

/// What the judgement of a message means for its session.
enum class Place : std::uint8_t {
  kNew,
  /// At or below the highest number seen.
  kDuplicate,
  /// The session was forgotten: another process holds the robot. The stream must stop.
  kVoid,
};

/// For views: the session of the robot's stream.
struct SessionView {
  bool connected = false;
  SystemTime connected_since;
  std::optional<model::SessionId> session;
  model::Seq settled_seq = 0;
  std::uint64_t missing = 0;
  /// More than kTakeoversPerMinuteMax takeovers in the last minute.
  bool contested = false;
};

/// The sessions of one robot in memory: their numbers, ack windows and remembered Rejects, and
/// which stream is the robot's. Outlives streams; as a CommitClient it learns of commits.
///
/// Thread: thread-safe by one mutex, never held across a call out. What only the robot's stream
/// may call says so.
class RobotSessions final : public CommitClient {
 public:
  RobotSessions() = default;

  // --- Streams (any stream of the robot) ---

  struct Attached {
    StreamPlace place = StreamPlace::kCurrent;
    /// Streams that must be woken: they were superseded.
    std::vector<StreamRef> to_wake;
    /// This attach took over from another stream.
    bool took_over = false;
    /// The robot changes hands more than kTakeoversPerMinuteMax times a minute.
    bool contested = false;
  };
  /// A new stream wants the robot. An older one is superseded and must confirm by Detach first.
  [[nodiscard]] Attached Attach(StreamRef stream, SteadyTime now, SystemTime system_now);
  [[nodiscard]] StreamPlace PlaceOf(StreamRef stream) const;
  /// The stream takes no more frames (its own thread says so). Returns the stream that is next.
  StreamRef Detach(StreamRef stream, SteadyTime now);

  // --- The robot's stream ---

  struct Begun {
    /// The id under which OpenStream is to be asked for.
    std::uint64_t open_id = 0;
    /// Goes with every record of the stream (Journal::Append).
    std::uint64_t generation = 0;
  };
  /// Opens the session on the robot's stream; creates it, forgetting the least recently used idle
  /// one over kSessionsMax. Nothing if all sessions wait for commits.
  [[nodiscard]] std::optional<Begun> Begin(const model::SessionId& session, SteadyTime now);
  /// Sessions in memory, for OpenRequest.sessions_held.
  [[nodiscard]] std::vector<model::SessionId> Held() const;
  /// True once the store has answered OpenStream `open_id`.
  [[nodiscard]] bool Opened(std::uint64_t open_id) const;
  /// What Welcome says, from what is known now: session memory, and the store's answer if it is
  /// here.
  [[nodiscard]] Resume ResumeFrom(const model::SessionId& session, std::uint64_t open_id,
                                  model::Seq settled_seq, model::Seq judged_seq);

  /// Sees one number: a duplicate, or new. `missing` becomes the range skipped just before it.
  struct Seen {
    Place place = Place::kNew;
    /// First and last number skipped; none if first is 0.
    model::Seq missing_first = 0;
    model::Seq missing_last = 0;
    /// Of a duplicate: its first copy waits for a commit, whose Ack answers it too.
    bool waits = false;
  };
  [[nodiscard]] Seen See(const model::SessionId& session, model::Seq seq);
  /// The number just seen is settled at once.
  void AddSettled(const model::SessionId& session, model::Seq seq);
  /// The number just seen waits for its commit. Returns by how much the window's own count grew: 0
  /// if the session was forgotten meanwhile.
  [[nodiscard]] std::int64_t AddWaiting(const model::SessionId& session, model::Seq seq);
  /// A rejection made at judgement, remembered for the next Welcome.
  void Remember(const model::SessionId& session, model::Seq seq, const model::Rejection& rejection);
  void AddGap();
  /// Whether the payload of a rejection for this reason is kept now: one a second.
  [[nodiscard]] bool KeepPayload(model::RejectReason reason, SteadyTime now);
  /// Whether a Notice of this field may be sent now: one a second a field, list indexes apart.
  [[nodiscard]] bool MayNotice(const std::string& field, SteadyTime now);

  /// Takes the state for an Ack, and the store's Rejects that were not told yet, in one look.
  [[nodiscard]] Progress Take(const model::SessionId& session);
  /// Messages and gap records of the robot that are not committed.
  [[nodiscard]] std::size_t in_flight() const { return in_flight_.load() + gaps_in_flight_.load(); }
  /// Of this session alone.
  [[nodiscard]] std::size_t waiting(const model::SessionId& session) const;

  // --- Views and the sweep ---

  [[nodiscard]] SessionView View() const;
  /// Forgets sessions that had no stream for `idle` and wait for nothing.
  void Sweep(SteadyTime now, milliseconds idle);

  // --- CommitClient ---

  StreamRef OnOpened(std::uint64_t open_id, const storage::OpenResult& result) override;
  StreamRef OnSettled(std::span<const Settled> settled, metrics::Ledger& ledger) override;
  StreamRef OnGapsWritten(std::size_t count) override;
  StreamRef OnFenced(metrics::Ledger& ledger) override;
  [[nodiscard]] std::uint64_t generation() const override { return generation_.load(); }

 private:
  struct Numbering {
    AckWindow window;
    /// Numbers up to this count as seen for counting missing alone.
    model::Seq missing_floor = 0;
    model::Seq hello_judged = 0;
    std::uint64_t missing = 0;
    std::deque<RejectedSeq> remembered;
    /// Rejects by the store, and arrivals of what commits released, that the stream has not taken
    /// yet: at most in_flight_uplinks_max of each.
    std::vector<RejectedSeq> untold;
    std::vector<SteadyTime> released;
    /// True once this process has judged a number of it or resumed it.
    bool known = false;
    SteadyTime last_used;
  };

  Numbering* Find(const model::SessionId& session);
  const Numbering* Find(const model::SessionId& session) const;
  bool MakeRoom();
  bool NoteTakeover(SteadyTime now);
  static void RememberIn(Numbering& numbering, RejectedSeq rejected);
  static void Count(const Settled& settled, Numbering& numbering, metrics::UplinkCounts& counts);

  mutable std::mutex mutex_;
  std::map<model::SessionId, Numbering> sessions_;
  StreamRef current_;
  /// Waits for the current one to confirm its end.
  StreamRef next_;
  /// The current stream must stop: superseded by next_, or fenced.
  bool current_superseded_ = false;
  bool contested_ = false;
  std::optional<model::SessionId> current_session_;
  SystemTime connected_since_;
  SystemTime next_since_;
  std::uint64_t open_id_ = 0;
  std::optional<storage::OpenResult> opened_;
  /// Welcome still waits for it.
  bool open_wanted_ = false;
  std::deque<SteadyTime> takeovers_;
  std::array<std::optional<SteadyTime>, model::kRejectReasons + 1> payload_kept_;
  std::map<std::string, SteadyTime> noticed_;
  std::atomic<std::size_t> in_flight_{0};
  std::atomic<std::size_t> gaps_in_flight_{0};
  std::atomic<std::uint64_t> generation_{1};
};

}  // namespace uplink::robot
