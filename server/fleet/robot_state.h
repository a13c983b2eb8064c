#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/record.h"
#include "server/fleet/presence.h"

namespace uplink::fleet {

/// Keys that a robot's live state keeps (validation rules: what is kept per robot).
inline constexpr std::size_t kExtrasMax = 1024;
inline constexpr std::size_t kHealthDevicesMax = 32;
inline constexpr std::size_t kConsumablesMax = 64;
inline constexpr std::size_t kDirectivesMax = 1024;

/// The latest value of each key, at most `kMax` of them: the least recently updated goes first.
template <typename Value, std::size_t kMax>
class LatestByKey {
 public:
  using Items = std::list<std::pair<std::string, Value>>;

  LatestByKey() = default;
  LatestByKey(const LatestByKey& other) : items_(other.items_) { Index(); }
  LatestByKey& operator=(const LatestByKey& other) {
    if (this != &other) {
      items_ = other.items_;
      Index();
    }
    return *this;
  }
  LatestByKey(LatestByKey&&) noexcept = default;
  LatestByKey& operator=(LatestByKey&&) noexcept = default;
  ~LatestByKey() = default;

  /// Returns the number of keys that had to go (0 or 1).
  std::size_t Put(std::string key, Value value) {
    if (const auto found = index_.find(key); found != index_.end()) {
      found->second->second = std::move(value);
      items_.splice(items_.end(), items_, found->second);
      return 0;
    }
    items_.emplace_back(std::move(key), std::move(value));
    index_.emplace(items_.back().first, std::prev(items_.end()));
    if (items_.size() <= kMax) return 0;
    index_.erase(items_.front().first);
    items_.pop_front();
    return 1;
  }

  /// Least recently updated first.
  [[nodiscard]] const Items& items() const { return items_; }

 private:
  void Index() {
    index_.clear();
    for (auto it = items_.begin(); it != items_.end(); ++it) index_.emplace(it->first, it);
  }

  Items items_;
  // Keys are views of the list's own strings, which do not move.
  std::unordered_map<std::string_view, typename Items::iterator> index_;
};

/// One reading of extras: the reading's own time, else its message's.
struct Extra {
  model::Value value;
  std::int64_t sampled_at_ms = 0;
};

/// The latest of each live kind, in stream order; no robot clock decides anything. A value.
struct LiveParts {
  std::optional<model::MotionTelemetry> motion;
  std::optional<model::StatusTelemetry> status;
  LatestByKey<Extra, kExtrasMax> extras;
  LatestByKey<model::SystemHealth, kHealthDevicesMax> health;
  std::optional<model::UsageTelemetry> usage;
  LatestByKey<model::ConsumableStatus, kConsumablesMax> consumables;
  LatestByKey<model::SpatialDirectiveStatus, kDirectivesMax> directives;
};

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

  /// Applies live records in order. All must be live kinds.
  void Apply(std::vector<model::Record>& records);
  /// A motion or status message that arrived at this time. It may have waited since: presence is
  /// judged at the latest time that any call named.
  void SignOfLife(SteadyTime steady, SystemTime system, const PresenceLimits& limits);
  /// The server stopped (true) or began again to read the robot's stream.
  enum class Reading : std::uint8_t { kHeldBack, kFlowing };
  void SetReading(Reading reading, SteadyTime now);
  /// The server itself stood still until now: what it did not hear meanwhile proves nothing.
  void NoteStall(SteadyTime now);
  void NoteClockSkew(std::int64_t skew_ms);
  /// A new stream begins: its dropped fields are counted from zero.
  void StreamBegan();
  void CountDropped(std::size_t fields);

  /// Brings presence up to date and returns it.
  Presence Sweep(SteadyTime steady, SystemTime system, const PresenceLimits& limits);
  [[nodiscard]] Presence presence() const;
  [[nodiscard]] bool held_back() const;

  /// Which live parts a snapshot copies: none; those without a key (motion, status, usage); all.
  enum class Parts : std::uint8_t { kNone, kUnkeyed, kAll };
  [[nodiscard]] StateSnapshot Snapshot(Parts parts) const;

 private:
  void Reach(SteadyTime steady, SystemTime system);
  void UpdatePresence(const PresenceLimits& limits);
  [[nodiscard]] PresenceFacts Facts(SteadyTime now) const;

  const SteadyTime server_started_;
  const SteadyTime known_since_;
  const PresenceChanged changed_;
  mutable std::mutex mutex_;
  LiveParts parts_;
  Presence presence_ = Presence::kUnknown;
  SystemTime presence_since_;
  /// The latest time that a call named.
  std::optional<SteadyTime> reached_;
  SystemTime reached_system_;
  std::optional<SteadyTime> last_sign_;
  std::optional<SystemTime> last_sign_system_;
  bool held_back_ = false;
  std::optional<SteadyTime> held_back_until_;
  std::optional<std::int64_t> clock_skew_ms_;
  std::int64_t fields_dropped_ = 0;
  std::uint64_t keys_evicted_ = 0;
};

}  // namespace uplink::fleet
