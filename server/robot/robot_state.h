#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/record.h"
#include "server/robot/live_parts.h"
#include "server/robot/presence.h"
#include "storage/live_row.h"

namespace uplink::robot {

/// A robot's state as it is now, copied for a reader. A value.
struct StateSnapshot {
  LiveParts parts;
  Presence presence = Presence::kUnknown;
  SystemTime presence_since;
  std::optional<SystemTime> last_sign_of_life;
  std::optional<std::int64_t> clock_skew_ms;
  std::int64_t fields_dropped = 0;
  std::uint64_t keys_evicted = 0;
};

/// Open mission runs of which the progress is kept; the least recently reported goes first.
inline constexpr std::size_t kOpenRunsMax = 16;

/// progress_x100 of one percent.
inline constexpr double kProgressAPercent = 100;
/// A computer that was up for longer than a century has no clock.
inline constexpr std::uint64_t kUptimeSMax = std::uint64_t{100} * 366 * 24 * 3600;

/// How a run is named among a robot's open runs.
[[nodiscard]] inline std::string RunKey(std::string_view mission_id, std::string_view run_id) {
  return std::string(mission_id).append("/").append(run_id);
}

/// What a robot's durable reports say of it now, for its series. A value.
struct Reported {
  /// Progress in percent of open runs, by mission and run; the last one reported last. Nothing
  /// where a report named none.
  LatestByKey<std::optional<double>, kOpenRunsMax> open_runs;
  /// By the server's clock.
  std::optional<SystemTime> booted_at;
};

/// Runs that ended before it was read from the store what was open, and are remembered until then.
inline constexpr std::size_t kEndedRunsMax = 64;

/// A robot's state as it stands, for one look under its lock.
struct StateView {
  const LiveParts& parts;
  const Reported& reported;
  Presence presence = Presence::kUnknown;
  SystemTime presence_since;
  std::optional<SystemTime> last_sign_of_life;
  /// The robot's own stream is not read now; or when that ended. Its silence is ours.
  bool held_back = false;
  std::optional<SteadyTime> stream_held_back_until;
  /// In this life of the server; the epoch if they did not.
  SteadyTime status_arrived;
  SteadyTime rcan_arrived;
};

/// Which live parts, by storage::LivePart.
using LivePartSet = std::bitset<storage::kLivePartKinds>;

/// What changed of a robot's live state since that was asked last. A value.
struct LiveChanges {
  LivePartSet changed;
  /// Only those that changed are set.
  LiveParts parts;
  std::optional<SystemTime> last_sign_of_life;
  std::optional<std::int64_t> clock_skew_ms;
};

/// What an earlier life of the server knew of a robot. A value.
struct LiveBefore {
  LiveParts parts;
  std::optional<SystemTime> last_sign_of_life;
  std::optional<std::int64_t> clock_skew_ms;
};

/// Live state and presence of one robot. Thread-safe: a short mutex, never held across I/O; one
/// thread at a time writes live parts (takeover hands the robot over).
class RobotState final {
 public:
  /// Told of each change of presence, in order, under the state's lock: it must be short and take
  /// no lock that is held while this state is asked.
  using PresenceChanged = std::function<void(Presence presence, SystemTime at)>;

  /// `known_since` and `system_now` are the same moment.
  RobotState(SteadyTime server_started, SteadyTime known_since, SystemTime system_now,
             PresenceChanged changed = {})
      : server_started_(server_started),
        known_since_(known_since),
        changed_(std::move(changed)),
        presence_since_(system_now) {}

  /// Applies live records in order. All must be live kinds. `arrived` is kept of a status, to tell
  /// which of two sources of a value is fresher.
  void Apply(std::vector<model::Record>& records, SteadyTime arrived);
  void Apply(model::RcanState&& state, SteadyTime arrived);
  /// A durable report that its robot's series look at; others change nothing.
  void Note(const model::Body& report, SystemTime received_at);
  /// A motion or status message that arrived at this time. It may have waited since: presence is
  /// judged at the latest time that any call named.
  void SignOfLife(SteadyTime steady, SystemTime system, const PresenceLimits& limits);
  /// The server stopped (true) or began again to read the robot's stream.
  enum class Reading : std::uint8_t { kHeldBack, kFlowing };
  void SetReading(Reading reading, SteadyTime now);
  /// The server itself stood still, or was behind with reading, until now: what it did not hear
  /// meanwhile proves nothing. Who was offline before stays so.
  void NoteStall(SteadyTime now);
  void NoteClockSkew(std::int64_t skew_ms);
  /// A new stream begins: its dropped fields are counted from zero.
  void StreamBegan();
  void CountDropped(std::size_t fields);

  /// What changed since the last call; nothing if nothing did.
  [[nodiscard]] std::optional<LiveChanges> TakeChanges();
  /// What was taken could not be kept: it counts as changed again.
  void PutBackChanges(const LivePartSet& changed);
  /// Takes over what is not known better by now. Presence stays as it is: it was not heard.
  void Restore(LiveBefore before);

  /// As above; what ended meanwhile is not taken.
  void Restore(Reported before);

  /// Brings presence up to date and returns it.
  Presence Sweep(SteadyTime steady, SystemTime system, const PresenceLimits& limits);
  [[nodiscard]] Presence presence() const;
  [[nodiscard]] bool held_back() const;

  /// Which live parts a snapshot copies: none; the small ones (PartTag::kSmall); all.
  enum class Parts : std::uint8_t { kNone, kSmall, kAll };
  [[nodiscard]] StateSnapshot Snapshot(Parts parts) const;
  /// Calls `look` with the state as it stands, under the lock: it must be short.
  template <typename Look>
  void LookAt(Look look) const {
    const std::lock_guard lock(mutex_);
    look(StateView{.parts = parts_,
                   .reported = reported_,
                   .presence = presence_,
                   .presence_since = presence_since_,
                   .last_sign_of_life = last_sign_system_,
                   .held_back = held_back_,
                   .stream_held_back_until = stream_held_back_until_,
                   .status_arrived = status_arrived_,
                   .rcan_arrived = rcan_arrived_});
  }

 private:
  void Reach(SteadyTime steady, SystemTime system);
  void UpdatePresence(const PresenceLimits& limits);
  [[nodiscard]] PresenceFacts Facts(SteadyTime now) const;

  const SteadyTime server_started_;
  const SteadyTime known_since_;
  const PresenceChanged changed_;
  mutable std::mutex mutex_;
  LiveParts parts_;
  LivePartSet parts_changed_;
  Reported reported_;
  LatestByKey<bool, kEndedRunsMax> ended_runs_;
  /// When the parts arrived in this life of the server; the epoch if they did not.
  SteadyTime status_arrived_;
  SteadyTime rcan_arrived_;
  /// The last sign of life or the clock's skew.
  bool signs_changed_ = false;
  Presence presence_ = Presence::kUnknown;
  SystemTime presence_since_;
  /// The latest time that a call named.
  std::optional<SteadyTime> reached_;
  SystemTime reached_system_;
  std::optional<SteadyTime> last_sign_;
  std::optional<SystemTime> last_sign_system_;
  bool held_back_ = false;
  /// Also until when the server itself stood still or was behind.
  std::optional<SteadyTime> held_back_until_;
  std::optional<SteadyTime> stream_held_back_until_;
  std::optional<std::int64_t> clock_skew_ms_;
  std::int64_t fields_dropped_ = 0;
  std::uint64_t keys_evicted_ = 0;
};

}  // namespace uplink::robot
