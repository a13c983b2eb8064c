#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/access_store.h"

namespace uplink::fleet {

/// Robots with settings that are held in memory, at least.
inline constexpr std::size_t kRobotSettingsMin = 100'000;
/// So many per robot of limits.robots_max: robots that were blocked or added need not be known.
inline constexpr std::size_t kSettingsPerRobot = 2;

/// The bound of RobotSettings.
[[nodiscard]] constexpr std::size_t RobotSettingsMax(std::size_t robots_max) {
  return std::max(kRobotSettingsMin, kSettingsPerRobot * robots_max);
}

/// Shared with readers, so it never changes.
using RobotSettingPtr = std::shared_ptr<const storage::RobotSetting>;

/// What operators set of robots, known to the fleet or not: the store's settings in memory. A robot
/// without any takes no place.
///
/// Limits: settings_max. Past it, a robot that is blocked or was added replaces one that has only
///         labels or a note; with none of those the new setting is left out.
/// Thread: thread-safe; Apply and Replace by one thread at a time.
class RobotSettings final {
 public:
  /// One robot's setting changed. Null: nothing was or is set.
  struct Change {
    std::string ruri;
    RobotSettingPtr before;
    RobotSettingPtr now;
    /// An operator asked that its streams end, since the last Apply: whatever time it bears, which
    /// is of another server's clock.
    bool disconnect = false;
  };
  using Changed = std::function<void(std::span<const Change>)>;

  explicit RobotSettings(std::size_t settings_max) : settings_max_(settings_max) {}

  /// Called by Apply and Replace for what they changed, on their thread, with no lock held. Call it
  /// before the first thread.
  void OnChange(Changed changed) { changed_ = std::move(changed); }

  /// Null if nothing is set of the robot.
  [[nodiscard]] RobotSettingPtr Find(std::string_view ruri) const;
  /// By RURI.
  [[nodiscard]] std::vector<RobotSettingPtr> All() const;
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] std::size_t settings_max() const { return settings_max_; }
  /// Settings that found no place, or lost it, since the last Replace.
  [[nodiscard]] std::uint64_t left_out() const;
  /// All settings of the store were taken over: a robot without any has none.
  void SetRead() { read_.store(true); }
  [[nodiscard]] bool is_read() const { return read_.load(); }

  /// Takes over settings, each as a whole. One whose version is not above the known one changes
  /// nothing.
  void Apply(std::vector<storage::RobotSetting> settings);
  /// Takes over all settings, whatever their versions: robots that are not among them have none. It
  /// asks no stream to end, except those of robots that are blocked now. Returns whether anything
  /// is other than before; only that is told.
  bool Replace(std::vector<storage::RobotSetting> settings);

 private:
  using Table = std::map<std::string, RobotSettingPtr, std::less<>>;

  /// The three below need the lock.
  [[nodiscard]] RobotSettingPtr FindLocked(std::string_view ruri) const;
  void Erase(const std::string& ruri);
  /// Appends the change, and that of a robot that lost its place.
  void Put(storage::RobotSetting setting, std::vector<Change>& changes);
  void Tell(std::span<const Change> changes) const;

  const std::size_t settings_max_;
  Changed changed_;
  mutable std::mutex mutex_;
  /// Robots that are blocked or were added, and those that only have labels or a note.
  Table decided_;
  Table noted_;
  std::uint64_t left_out_ = 0;
  std::atomic<bool> read_{false};
};

}  // namespace uplink::fleet
