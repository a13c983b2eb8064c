#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/log/logger.h"
#include "server/view/parts.h"
#include "server/view/queries.h"
#include "server/view/robots_query.h"
#include "server/view/watch_probe.h"

namespace uplink::view {

/// Watches at a time, of all callers and of one.
inline constexpr std::size_t kWatchesMax = 1'000;
inline constexpr std::size_t kWatchesPerCallerMax = 16;
/// A watch that has changes to take, and takes none for so long, ends.
inline constexpr std::chrono::seconds kWatchTakeWait{60};
/// Changes that one Watch::Take returns, and about how many bytes of large parts.
inline constexpr std::size_t kWatchTakeMax = 128;
inline constexpr std::size_t kWatchTakeBytesMax = 512UL * 1024;

/// Which robots are watched, by whom. A value.
struct WatchQuery {
  /// `fleets` restricts it to the caller's scope, as in RobotsQuery.
  RobotsFilter filter{};
  PartSet parts = PartSet::OfLists();
  /// Counts in kWatchesPerCallerMax: what tells the caller from others, such as `token north-1`.
  /// Empty: callers cannot be told apart, and kWatchesMax alone bounds them.
  std::string caller{};
};

/// A robot as it was at one moment, shared by the watches that show the same parts of it.
///
/// Thread: thread-safe.
class WatchedRobot final {
 public:
  WatchedRobot(RobotView view, const PartSet& parts);
  WatchedRobot(const WatchedRobot&) = delete;
  WatchedRobot& operator=(const WatchedRobot&) = delete;
  ~WatchedRobot();

  [[nodiscard]] const RobotView& view() const { return view_; }
  [[nodiscard]] const PartSet& parts() const { return parts_; }
  /// The v1::Robot in its JSON mapping (ToJson), made once. Errors: of ToJson.
  [[nodiscard]] const absl::StatusOr<std::string>& json() const;

 private:
  struct Text;
  const RobotView view_;
  const PartSet parts_;
  const std::unique_ptr<Text> text_;
};

/// A robot that matches, as it is now: new to the watch, or changed.
using RobotShown = std::shared_ptr<const WatchedRobot>;
/// A robot that was shown no longer matches, has left the caller's scope, or has left memory.
struct RobotRemoved {
  std::string ruri;
};
/// Every robot that matched when the watch began was shown.
struct SnapshotShown {
  std::int64_t robots = 0;
};
/// A v1::RobotChange as a value.
using WatchChange = std::variant<RobotShown, RobotRemoved, SnapshotShown>;

/// Why a reader ends its watch. Closed.
enum class WatchEnd : std::uint8_t {
  /// Its client, or the connection of that, has gone.
  kLeft,
  /// Its caller may not watch any more.
  kDenied,
  /// The server ends the connection.
  kDrained,
};

/// One reader's watch; ends with this object, and with a line `watch_ended`.
///
/// Thread: Take by one thread at a time, which may wait for the store for kBriefLookWait
///         (Queries::Now), and not once the Watches are gone; the end by any.
class Watch {
 public:
  virtual ~Watch() = default;
  /// The next changes in order, at most kWatchTakeMax. None: there is nothing now; `ready` of Begin
  /// tells once there is. What changed several times since comes once, as it is now.
  ///
  /// Errors: the watch is over, and so it stays: kDeadlineExceeded after kWatchTakeWait;
  ///         kUnavailable once the server stops. The message is a sentence for the client.
  [[nodiscard]] virtual absl::StatusOr<std::vector<WatchChange>> Take() = 0;
  /// For the line about its end: kLeft unless this says otherwise. Not beside another call.
  virtual void NoteEnd(WatchEnd why) = 0;
};

class WatchBook;

/// All watches over the robots of the fleet. A sweep looks at each robot, by what is cheap to take
/// of it, and notes for each watch which ones changed; robots' own threads do nothing for that. A
/// watch holds marks of robots, never their contents, so that it does not grow however slow its
/// reader is.
///
/// Robots that other processes hold change as those write them to the store (Robot.held_by says
/// so).
///
/// Limits: kWatchesMax, kWatchesPerCallerMax; per watch two bits per robot, and the RURIs of robots
///         that it must be told are gone.
/// Thread: thread-safe; Sweep by one thread at a time.
class Watches final {
 public:
  /// All of them outlive it.
  struct Context {
    const Clock& clock;
    fleet::Fleet& fleet;
    Queries& queries;
    WatchProbe& probe;
    const log::Logger& logger;
  };
  explicit Watches(const Context& context);
  Watches(const Watches&) = delete;
  Watches& operator=(const Watches&) = delete;
  ~Watches() { Stop(); }

  /// Begins a watch. Its first changes are a snapshot, then its end, then what changes. `ready` is
  /// called on the sweep's thread, with no lock held, whenever there is something to take after a
  /// Take that returned none, and when the watch is over; it must be short. One call may come after
  /// the watch was destroyed, so `ready` must own what it touches.
  ///
  /// Errors: kResourceExhausted at a bound; kUnavailable once the server stops.
  [[nodiscard]] absl::StatusOr<std::unique_ptr<Watch>> Begin(WatchQuery query,
                                                             std::function<void()> ready);

  /// Notes what changed since the last sweep. Due each view.watch_interval: this is why a watch
  /// shows a robot at most once in that time.
  void Sweep();
  /// Ends all watches, and lets none begin.
  void Stop();

  [[nodiscard]] std::size_t size() const;

 private:
  /// Watches that are not over share it.
  const std::shared_ptr<WatchBook> book_;
};

}  // namespace uplink::view
