#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/fleet/claim.h"
#include "server/fleet/entry.h"
#include "server/fleet/fleet_tallies.h"
#include "server/fleet/gateway_robots.h"
#include "server/fleet/odd_fleets.h"
#include "server/fleet/robot_settings.h"
#include "server/robot/robot.h"

namespace uplink::fleet {

/// The counts of robots that this process judges.
struct PresenceCounts : PresenceTally {
  /// The counts of robots that other processes hold, by the presence that those wrote.
  PresenceTally elsewhere;
};

/// A robot of the fleet. It leaves memory only if no one keeps this pointer: keep it for one look,
/// and its RURI, or a weak pointer, beyond that.
using RobotPtr = std::shared_ptr<robot::Robot>;

/// Robots beyond `robots_max` that may be leaving memory: so many new robots may enter a full fleet
/// at once.
inline constexpr std::size_t kLeavingMax = 1'024;

/// All robots by RURI: at most `robots_max`, and those that are leaving memory. Thread-safe.
class Fleet final {
 public:
  /// `twins`: the presence limits of robots behind a broker, if they differ. `boot` shows that the
  /// machine was suspended; null: nothing does.
  Fleet(
      const Clock& clock, std::size_t robots_max, const robot::PresenceLimits& presence,
      const robot::PresenceLimits& twins = {.timeout = config::CyberwaveConfig().presence_timeout},
      const BootClock* boot = nullptr);

  /// Call it before the first robot and the first thread.
  void OnPresence(robot::PresenceChanged changed) { changed_ = std::move(changed); }
  /// So many fleets have tallies of their own (metrics.fleets_max). Call it before the first
  /// thread.
  void ShowFleets(std::size_t fleets_max) { shown_fleets_ = ShownFleets(fleets_max); }

  /// Finds a robot that speaks. It is admitted if it is new, and stays if it was leaving. At
  /// robots_max another one leaves for it (SetRoom); kResourceExhausted if none can, and Entry's
  /// statuses.
  [[nodiscard]] absl::StatusOr<RobotPtr> FindOrAdmit(const model::RobotId& id);
  struct Admission {
    /// Null if the robot is refused.
    RobotPtr robot;
    Refusal refusal = Refusal::kNone;
    /// The claim has moved it from another fleet.
    bool moved = false;
  };
  /// The same for a stream that may be a gateway's. A gateway that speaks for a fleet is refused
  /// robots of other fleets, and may bring in GatewayRobotsMax new ones.
  [[nodiscard]] Admission FindOrAdmitBy(const Claim& claim);
  /// Admits a robot that the store has. Null, and nothing changes, if it is known already.
  /// kResourceExhausted at robots_max.
  [[nodiscard]] absl::StatusOr<RobotPtr> AdmitNew(const model::RobotId& id);
  /// Null if it is unknown, or has left memory (RemoveLeft).
  [[nodiscard]] RobotPtr Find(std::string_view ruri) const;
  /// All robots, in the order in which they were admitted.
  [[nodiscard]] std::vector<RobotPtr> All() const;
  /// All robots by RURI.
  [[nodiscard]] std::vector<RobotPtr> Sorted() const;
  /// Without leaving robots.
  [[nodiscard]] std::size_t size() const { return all_.load() - leaving_.load(); }
  [[nodiscard]] std::size_t robots_max() const { return robots_max_; }
  /// Robots that are leaving memory.
  [[nodiscard]] std::size_t leaving() const { return leaving_.load(); }
  /// Robots that left memory, for any reason, since the start.
  [[nodiscard]] std::uint64_t forgotten() const { return forgotten_.load(); }
  /// The memory of all live state, robot by robot. LiveBudget bounds it.
  [[nodiscard]] const std::shared_ptr<robot::LiveTotal>& live_total() const { return live_total_; }
  /// Grows whenever a robot enters or leaves memory.
  [[nodiscard]] std::uint64_t changes() const { return changes_.load(); }

  /// The refused names of fleets. store::RobotLoader and AdmitNew tell it the fleets in the store.
  [[nodiscard]] OddFleets& odd_fleets() { return odd_fleets_; }

  /// Robots in memory that the gateway brought in (GatewayRobots).
  [[nodiscard]] std::size_t gateway_robots(const std::string& gateway) const {
    return gateway_robots_.of(gateway);
  }
  [[nodiscard]] std::size_t gateway_robots_max() const { return gateway_robots_.per_gateway_max(); }

  /// Whether the claim may bring in the robot, which is `known` if it is in memory.
  [[nodiscard]] Refusal Judge(const Claim& claim, robot::Robot* known) {
    return entry_.Judge(claim, known, odd_fleets_.is_read(), clock_.System());
  }
  /// Who may come in.
  [[nodiscard]] Entry& entry() { return entry_; }
  [[nodiscard]] const Entry& entry() const { return entry_; }
  /// Operators changed settings (RobotSettings::OnChange): ends the streams of blocked robots, and
  /// of those that are disconnected. A twin has no connection of its own here: the broker's reader
  /// takes no message of a blocked one, and none is disconnected.
  void OnSettings(std::span<const RobotSettings::Change> changes);

  // --- Leaving memory ---

  /// Sets the robots that may leave for a new one at robots_max; the first leaves last. Those that
  /// are not idle by then stay.
  void SetRoom(std::vector<std::weak_ptr<robot::Robot>> room);
  /// The robot begins to leave, unless kLeavingMax already do. False if it is leaving already, or
  /// may not leave.
  bool BeginLeaving(robot::Robot& robot,
                    robot::Robot::LeaveWhen when = robot::Robot::LeaveWhen::kNotOnline);
  /// The robot has a stream, so it stays after all.
  void Keep(robot::Robot& robot);
  /// Leaving robots that the journal must let go of.
  [[nodiscard]] std::vector<RobotPtr> Leaving() const;
  /// Removes the robots that the journal has let go of and no one keeps. Returns them.
  std::vector<RobotPtr> RemoveLeft();

  /// The limits of the relay's robots.
  [[nodiscard]] const robot::PresenceLimits& presence_limits() const { return presence_; }
  /// The limits by which this robot is judged.
  [[nodiscard]] const robot::PresenceLimits& presence_limits_of(const robot::Robot& robot) const {
    return IsTwin(robot) ? twins_ : presence_;
  }
  /// The relay listens from now on: `presence.startup_grace` begins, and the silence of known
  /// robots counts. Call it before the first sweep.
  void BeginListening();

  /// A sweep is due each second. A sweep later than this after the last one shows that the server
  /// stood still, and judges no robot.
  static constexpr std::chrono::seconds kSweepLate{3};
  /// A standstill of this length breaks connections: agents ping from every 10 s on and wait some
  /// seconds for the answer (docs/integrate/protocol.md). Its robots must come back first, so
  /// presence.startup_grace begins anew.
  static constexpr std::chrono::seconds kStandstillBreaks{15};
  static_assert(kStandstillBreaks > kSweepLate);

  /// Whether this process learns what robots send. While it does not, and for a presence timeout
  /// after that, robots that are silent for too long become unknown, not offline.
  enum class HearingState : std::uint8_t {
    kUpToDate,
    /// Robots that left may stream to another process that cannot reach the store, and so cannot
    /// tell. A robot with an open stream here may have left too, if the network cut it off
    /// silently: its silence counts once the stream's peer has answered
    /// (RobotState::AskBeforeOffline). Twins have no stream: for them it means kBehind.
    kHereAlone,
    /// Messages of robots lie unread. For twins also: their broker is not heard.
    kBehind,
  };

  /// The periodic check: updates the presence of every robot that this process judges, forgets
  /// sessions that have been idle for `session_idle`, and counts. `hearing` is the relay's,
  /// `twins_hearing` the broker's.
  PresenceCounts Sweep(milliseconds session_idle, HearingState hearing = HearingState::kUpToDate,
                       HearingState twins_hearing = HearingState::kUpToDate);
  /// The broker was not heard until now, perhaps for less than a sweep: no twin's silence until now
  /// counts.
  void NoteTwinsUnheard();
  /// By this time after the store was replaced, every other process that reaches the new one knows
  /// that, and has ended the streams of lost holds. A process that does not reach it is late by
  /// then (store::kLateAfter).
  static constexpr std::chrono::seconds kReplacedKnown{10};
  /// Notes a look at the store, which began then and showed the robots that other processes hold.
  void NoteStoreLooked(SteadyTime began) { store_looked_.store(began); }
  /// From now on the store may be another one that lacks the last commits, and may name this
  /// process as the holder of a robot that another process hears. So no robot's silence counts
  /// until kReplacedKnown from now, and robots that became offline since the last look
  /// (NoteStoreLooked) are unknown until then, as after a stall.
  void NoteStoreReplaced();
  /// Whether the last sweep came late.
  [[nodiscard]] bool stood_still() const { return stood_still_for() > SteadyTime::duration(0); }
  /// The time between the last two sweeps, including suspends of the machine; zero unless the last
  /// came late.
  [[nodiscard]] SteadyTime::duration stood_still_for() const { return stood_still_for_.load(); }
  /// The counts of the last sweep that judged.
  [[nodiscard]] PresenceCounts presence_counts() const {
    const std::lock_guard lock(counts_mutex_);
    return counts_;
  }
  /// The same by fleet, as metrics show them (ShownFleets).
  [[nodiscard]] FleetTallies fleet_tallies() const;

 private:
  static constexpr std::size_t kShards = 64;
  struct Shard {
    mutable std::mutex mutex;
    std::unordered_map<std::string, RobotPtr> robots;
  };
  [[nodiscard]] static bool IsTwin(const robot::Robot& robot) {
    return robot.source() == model::MessageSource::kCyberwave;
  }
  /// Call it with the shard's lock held, and a place taken.
  [[nodiscard]] RobotPtr Admit(Shard& shard, const model::RobotId& id,
                               robot::Registration registration = robot::Registration::kFits);
  /// As Admit; at robots_max another one leaves for it.
  [[nodiscard]] Admission AdmitBy(Shard& shard, const Claim& claim);
  /// False at robots_max.
  bool TakePlace();
  [[nodiscard]] absl::Status Full() const;
  /// Makes another robot begin to leave. False if none can.
  bool MakeRoom();
  /// False if the robot is kept elsewhere, or stays.
  bool Remove(const RobotPtr& robot);
  /// Judges a robot that came before the store was read; one that is refused leaves memory.
  void JudgeAgain(robot::Robot& robot, SystemTime now) {
    entry_.JudgeAgain(robot, odd_fleets_.is_read(), now);
    const bool goes = robot.registration() == robot::Registration::kRefused && robot.idle();
    if (goes) BeginLeaving(robot, robot::Robot::LeaveWhen::kAtOnce);
  }
  /// Notes for the robot's presence what its silence until now can prove.
  void ApplyHearing(robot::Robot& robot, HearingState hearing, SteadyTime now);
  /// How long the server stood still before this sweep; zero if it did not.
  [[nodiscard]] SteadyTime::duration StoodStill(SteadyTime now);
  [[nodiscard]] Shard& ShardOf(std::string_view ruri);
  [[nodiscard]] const Shard& ShardOf(std::string_view ruri) const;

  const Clock& clock_;
  const std::size_t robots_max_;
  const std::shared_ptr<robot::LiveTotal> live_total_ = std::make_shared<robot::LiveTotal>();
  const robot::PresenceLimits presence_;
  const robot::PresenceLimits twins_;
  /// When the relay began to listen; before that, when the fleet was made.
  std::atomic<SteadyTime> started_;
  robot::PresenceChanged changed_;
  const BootClock* const boot_;
  /// By the boot clock, if there is one. Zero before the first.
  std::atomic<SteadyTime> last_sweep_{SteadyTime()};
  /// The latest NoteStoreLooked: robots that became offline after it are in doubt. If this process
  /// has the store alone, there is no look and no doubt.
  std::atomic<SteadyTime> store_looked_{SteadyTime::max()};
  std::atomic<SteadyTime::duration> stood_still_for_{SteadyTime::duration(0)};
  std::array<Shard, kShards> shards_;
  GatewayRobots gateway_robots_;
  OddFleets odd_fleets_;
  Entry entry_;
  /// Taken places: admitted robots, and those about to be.
  std::atomic<std::size_t> all_{0};
  std::atomic<std::size_t> leaving_{0};
  std::atomic<std::uint64_t> changes_{0};
  std::atomic<std::uint64_t> forgotten_{0};
  mutable std::mutex admitted_mutex_;
  /// In order.
  std::vector<RobotPtr> admitted_;
  std::mutex room_mutex_;
  std::vector<std::weak_ptr<robot::Robot>> room_;
  mutable std::mutex counts_mutex_;
  PresenceCounts counts_;
  FleetTallies tallies_;
  /// The sweep's.
  ShownFleets shown_fleets_{config::MetricsConfig().fleets_max};
};

}  // namespace uplink::fleet
