#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "server/limits/recent_times.h"
#include "server/loop/wake.h"
#include "server/robot/limits.h"

namespace uplink::robot {

/// Where a stream stands among the robot's streams.
enum class Standing : std::uint8_t {
  /// It is the robot's stream.
  kCurrent,
  /// It waits until the older stream has confirmed its end.
  kWaiting,
  /// A newer stream took over, or another process holds the robot: it must stop and Detach.
  kSuperseded,
  /// It was ended on request: it must stop and Detach.
  kEnded,
  /// The store went back: it lacks what it told of the robot. It must stop and Detach.
  kWentBack,
  /// The store has the robot in another fleet than the gateway that speaks for it: it must stop and
  /// Detach.
  kOtherFleet,
};

/// Which stream is the robot's: a newer one replaces the older, which must confirm its end first.
/// Confined to its owner's lock.
///
/// Bounds: one current and one waiting stream; the times of kTakeoversPerMinuteMax + 1 takeovers.
class Takeover final {
 public:
  struct Attached {
    Standing standing = Standing::kCurrent;
    /// Streams that must be woken: they were superseded.
    std::vector<loop::StreamRef> to_wake;
    /// This attach took over from another stream.
    bool took_over = false;
    /// The robot changes hands more than kTakeoversPerMinuteMax times per minute, from now on.
    bool contested = false;
  };
  /// A new stream wants the robot, by itself or through this gateway.
  [[nodiscard]] Attached Attach(loop::StreamRef stream, SteadyTime now, SystemTime system_now,
                                std::string gateway = {});
  [[nodiscard]] Standing StandingOf(loop::StreamRef stream) const;
  /// The stream takes no more frames: the one that waits, if any, becomes the robot's. Returns the
  /// robot's stream, or none if the one that left was not it.
  loop::StreamRef Detach(loop::StreamRef stream);
  /// The current stream must stop, for this reason: another process holds the robot, or the store
  /// went back.
  void Stop(Standing standing);
  /// The stream may not speak for the robot, as the store has it: it must stop if it is current.
  void Refuse(loop::StreamRef stream);
  /// The current stream is to stop, though nothing takes its place.
  void End();
  /// Lets old takeovers go, so that a robot that calmed down is contested no more.
  void Sweep(SteadyTime now);

  /// The robot's stream; none if it has none.
  [[nodiscard]] loop::StreamRef current() const { return current_; }
  /// When the robot's stream, or the last one, came.
  [[nodiscard]] SystemTime connected_since() const { return connected_since_; }
  /// Through which gateway that stream came; empty: the robot spoke by itself, or never here.
  [[nodiscard]] const std::string& gateway() const { return gateway_; }
  /// More than kTakeoversPerMinuteMax takeovers in the last minute.
  [[nodiscard]] bool contested() const { return contested_; }

 private:
  /// Returns true if the robot became contested by it.
  bool AddTakeover(SteadyTime now);

  loop::StreamRef current_;
  /// Waits for the current one to confirm its end.
  loop::StreamRef next_;
  /// Anything but kCurrent: it must stop.
  Standing current_standing_ = Standing::kCurrent;
  bool contested_ = false;
  SystemTime connected_since_;
  SystemTime next_since_;
  std::string gateway_;
  std::string next_gateway_;
  limits::RecentTimes<kTakeoversPerMinuteMax + 1> takeovers_;
};

}  // namespace uplink::robot
