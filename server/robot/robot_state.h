#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/connection.h"
#include "schema/model/record.h"
#include "server/robot/backlog.h"
#include "server/robot/clock_skew.h"
#include "server/robot/holding.h"
#include "server/robot/live_parts.h"
#include "server/robot/live_total.h"
#include "server/robot/presence.h"
#include "server/robot/presence_track.h"
#include "server/robot/reports.h"
#include "server/robot/tracked_live_parts.h"
#include "storage/live_row.h"

namespace uplink::robot {

/// A copy of a robot's current state. A value.
struct StateSnapshot {
  LiveParts parts;
  /// As TrackedLiveParts::changes.
  std::uint64_t live_changes = 0;
  Presence presence = Presence::kUnknown;
  SystemTime presence_since;
  std::optional<SystemTime> last_sign_of_life;
  /// As RobotState's.
  std::optional<SystemTime> parked_until{};
  bool flapping = false;
  std::optional<std::int64_t> clock_skew_ms;
  std::optional<Backlog> backlog{};
  std::int64_t fields_dropped = 0;
  std::uint64_t keys_evicted = 0;
  /// As RobotState::last_end.
  std::optional<model::ConnectionEnd> last_end;
  /// Set if another process holds the robot. Then parts, last sign and skew are unknown here.
  std::optional<Foreign> foreign;
};

/// A robot's current state, for one look under its lock.
struct StateView {
  const LiveParts& parts;
  const Reported& reported;
  Presence presence = Presence::kUnknown;
  SystemTime presence_since;
  std::optional<SystemTime> last_sign_of_life;
  /// As StateSnapshot's.
  std::optional<Backlog> backlog{};
  /// The robot's own stream is not read, or when that ended: its silence is the server's.
  bool held_back = false;
  std::optional<SteadyTime> stream_held_back_until;
  /// Times since the server's start; the epoch if they did not come, or were dropped since.
  SteadyTime status_arrived;
  SteadyTime rcan_arrived;
  /// Another process holds the robot: only its presence is known here.
  bool foreign = false;
};

/// The changes of a robot's live state since the last call. A value.
struct LiveChanges {
  LivePartSet changed;
  /// Only changed parts are set.
  LiveParts parts;
  std::optional<SystemTime> last_sign_of_life;
  std::optional<std::int64_t> clock_skew_ms;
};

/// A robot's state before the server's start. A value.
struct LiveBefore {
  LiveParts parts;
  std::optional<SystemTime> last_sign_of_life;
  std::optional<std::int64_t> clock_skew_ms;
};

/// Live state and presence of one robot. Thread-safe: a short mutex, never held across I/O; one
/// thread at a time writes live parts (takeover hands the robot over).
class RobotState final {
 public:
  /// As PresenceTrack's. Of a robot that goes offline `why` says why its last connection ended;
  /// empty: one is open, there was none here, or the robot has another presence.
  using PresenceChanged = std::function<void(const storage::StoredPresence& now,
                                             std::optional<model::ConnectionEnd> why)>;

  /// `known_since` and `system_now` are the same moment.
  RobotState(SteadyTime server_started, SteadyTime known_since, SystemTime system_now,
             PresenceChanged changed = {})
      : presence_(server_started, known_since, system_now,
                  // The track calls under our lock.
                  [this, changed = std::move(changed)](const storage::StoredPresence& now) {
                    const bool gone = now.presence == Presence::kOffline;
                    if (changed) changed(now, gone ? last_end_ : std::nullopt);
                  }) {}

  /// Counts its memory in `total` from now on. Call it before its first part, and before it is
  /// shared between threads.
  void CountIn(std::shared_ptr<LiveTotal> total);

  /// As PresenceTrack's.
  void BeginListening(SteadyTime now);
  /// Applies live records, which must be of live kinds, in order. `arrived` is kept for a status,
  /// to tell which of two sources of a value is fresher. Checks the total at the end.
  void Apply(std::vector<model::Record>& records, SteadyTime arrived);
  void Apply(model::RcanState&& state, SteadyTime arrived);
  /// Keeps a durable report that its robot's series need; ignores others.
  void KeepReport(const model::Body& report, SystemTime received_at);
  /// A motion or status message that arrived at this time, and may have waited since: presence is
  /// judged at the latest time that any call named.
  void SignOfLife(SteadyTime steady, SystemTime system, const PresenceLimits& limits);
  using Reading = PresenceTrack::Reading;
  /// The server stopped or resumed reading the robot's stream.
  void SetReading(Reading reading, SteadyTime now);
  /// As PresenceTrack::AddStall.
  void NoteStall(SteadyTime until);
  /// As PresenceTrack's.
  void NoteReplaced(const PresenceTrack::Replaced& replaced);
  /// As PresenceTrack's. If true, TakeAskPeer returns true once.
  bool AskBeforeOffline(SteadyTime now, const PresenceLimits& limits);
  /// The robot's stream must ask its peer for an answer.
  [[nodiscard]] bool TakeAskPeer() { return ask_peer_.load() && ask_peer_.exchange(false); }
  /// As PresenceTrack's.
  void NotePeerAnswered(SteadyTime now, const PresenceLimits& limits);
  /// As PresenceTrack's.
  void ForgetSigns(SteadyTime unknown_until, SystemTime system_now);
  /// A batch with this head arrived.
  void NoteBatch(const BatchHead& head, SteadyTime now, SystemTime system_now);
  /// A new stream begins: what is counted or said within a stream begins anew.
  void BeginStream();
  void CountDropped(std::size_t fields);

  // --- Whether it is parked ---

  /// The robot's stream says that it leaves until `until`, which is to the millisecond. Signs of
  /// life of that stream end nothing (EndParkingStream).
  void Park(SystemTime until, SteadyTime now) { Park(until, SteadyTime::max(), now); }
  /// Signs of life before `signs_count_from` were on their way when it said so.
  void Park(SystemTime until, SteadyTime signs_count_from, SteadyTime now) {
    const std::lock_guard lock(mutex_);
    presence_.Park(until, signs_count_from, now);
  }
  /// The stream on which it said so has ended: from now on a sign of life ends the parking.
  void EndParkingStream(SteadyTime now) {
    const std::lock_guard lock(mutex_);
    presence_.EndParkingStream(now);
  }
  /// Until when it is parked, as of the last sweep; empty: it is not. Of a robot that another
  /// process holds, what that one wrote.
  [[nodiscard]] std::optional<SystemTime> parked_until() const {
    const std::lock_guard lock(mutex_);
    return presence_.parked_until();
  }
  /// It comes and goes (Flaps), as of the last sweep.
  [[nodiscard]] bool flapping() const {
    const std::lock_guard lock(mutex_);
    return presence_.flapping();
  }

  /// Memory of its live parts.
  [[nodiscard]] std::size_t live_bytes() const;
  [[nodiscard]] LivePartBytes live_part_bytes() const;
  /// Drops a live part to free its memory; later values are held again. The store forgets it too,
  /// and a pending restore does not bring it back. Returns the freed bytes.
  std::size_t DropLivePart(storage::LivePart part);

  /// The changes since the last call; empty if there are none.
  [[nodiscard]] std::optional<LiveChanges> TakeChanges();
  /// The taken changes could not be stored: they count as changed again.
  void PutBackChanges(const LivePartSet& changed);
  /// Takes over older values that have no newer ones and were not dropped, unless the hold has
  /// changed. Presence stays as it is, since the robot was not heard.
  void Restore(LiveBefore before, storage::Epoch held_since);
  /// As above; leaves out runs that ended meanwhile.
  void Restore(Reported before, storage::Epoch held_since);

  // --- Its connections: streams, a twin's clients, connections of a drone's calls ---

  /// One begins.
  void BeginConnection() {
    const std::lock_guard lock(mutex_);
    ++connections_;
    last_end_.reset();
  }
  /// One ends, for each that began.
  void EndConnection(model::ConnectionEnd why) {
    const std::lock_guard lock(mutex_);
    if (--connections_ == 0) last_end_ = why;
  }
  /// Why the last one ended; empty while one is open, and before the first.
  [[nodiscard]] std::optional<model::ConnectionEnd> last_end() const {
    const std::lock_guard lock(mutex_);
    return last_end_;
  }

  // --- Who holds the robot ---

  /// A stream of it began here at `now`. From now on this process judges it, even if another one
  /// holds it, and counts its silence from `now` at the earliest. An OpenStream tells the store.
  void Claim(SteadyTime now);
  /// No stream of it is here any more. The store's word about its holder counts again.
  void EndClaim();
  /// This process holds it. What the former holder stored, if anything, must be restored.
  void BeginHold(const HoldNews& news, SteadyTime now, SystemTime system_now);
  /// Another process holds it: forgets everything known of it. Its presence stays until that
  /// process is known.
  void Lose();
  /// Another process holds it and wrote this. No effect if this process holds it or has a stream of
  /// it.
  void FollowHolder(Foreign foreign, const storage::StoredPresence& presence);
  /// Another process holds it: its live data is not kept here.
  [[nodiscard]] bool foreign() const {
    const std::lock_guard lock(mutex_);
    return foreign_.has_value();
  }
  /// The epoch since which this process holds it; 0 if it does not, or the store has not said so.
  [[nodiscard]] storage::Epoch held_since() const;
  /// The store's state of it must be restored (Restore); nothing is checkpointed before.
  [[nodiscard]] bool needs_restore() const;
  /// It was restored under this hold.
  void SetRestored(storage::Epoch held_since);

  /// Updates whether it is parked and flaps, and its presence, which it returns; empty if another
  /// process judges it.
  std::optional<Presence> Sweep(SteadyTime steady, SystemTime system, const PresenceLimits& limits);
  [[nodiscard]] Presence presence() const;
  [[nodiscard]] SystemTime presence_since() const;
  [[nodiscard]] bool held_back() const {
    const std::lock_guard lock(mutex_);
    return presence_.held_back();
  }

  /// Which live parts a snapshot copies: none; the small ones (PartTag::kSmall); all.
  enum class Parts : std::uint8_t { kNone, kSmall, kAll };
  [[nodiscard]] StateSnapshot Snapshot(Parts parts) const;
  /// Calls `look` with the current state, under the lock: it must be short.
  template <typename Look>
  void LookAt(Look look) const {
    const std::lock_guard lock(mutex_);
    look(StateView{.parts = live_.parts(),
                   .reported = reports_.reported(),
                   .presence = presence_.presence(),
                   .presence_since = presence_.since(),
                   .last_sign_of_life = presence_.last_sign(),
                   .backlog = backlog_,
                   .held_back = presence_.held_back(),
                   .stream_held_back_until = presence_.stream_held_back_until(),
                   .status_arrived = status_arrived_,
                   .rcan_arrived = rcan_arrived_,
                   .foreign = foreign_.has_value()});
  }

 private:
  /// Forgets what was heard here. Under the lock.
  void Forget();

  mutable std::mutex mutex_;
  TrackedLiveParts live_;
  /// Null: it counts in no total. Set before it is shared.
  std::shared_ptr<LiveTotal> live_total_;
  Reports reports_;
  /// When the parts arrived since the server's start; the epoch if they did not, or were dropped
  /// since.
  SteadyTime status_arrived_;
  SteadyTime rcan_arrived_;
  /// The last sign of life or the estimate of the clock's skew changed.
  bool signs_changed_ = false;
  /// Outside the lock, since a stream reads it at each wake.
  std::atomic<bool> ask_peer_{false};
  PresenceTrack presence_;
  ClockSkew clock_skew_;
  /// Empty: the robot's stream has not said it.
  std::optional<Backlog> backlog_;
  std::int64_t fields_dropped_ = 0;
  std::uint64_t keys_evicted_ = 0;
  /// Set while another process holds it.
  std::optional<Foreign> foreign_;
  storage::Epoch held_since_ = 0;
  /// A stream of it is here.
  bool claimed_ = false;
  /// A claim ended before the store said that the robot is ours. It may be elsewhere since, so what
  /// was heard then is not newer than the store's state.
  bool claim_ended_unheld_ = false;
  bool needs_restore_ = false;
  std::uint32_t connections_ = 0;
  /// Set while there are none.
  std::optional<model::ConnectionEnd> last_end_;
};

}  // namespace uplink::robot
