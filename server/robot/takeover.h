#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "server/limits/recent_times.h"
#include "server/loop/wake.h"
#include "server/robot/limits.h"

namespace uplink::robot {

/// A stream's standing among the robot's streams.
enum class Standing : std::uint8_t {
  /// It is the robot's stream.
  kCurrent,
  /// It waits until the older stream has confirmed its end.
  kWaiting,
  /// A newer stream took over, or another process holds the robot: it must stop and Detach.
  kSuperseded,
  /// An operator forgets the robot: it must stop and Detach.
  kEnded,
  /// An operator blocked the robot, or disconnects it: it must stop and Detach.
  kBlocked,
  kDisconnected,
  /// It came before the store was read, and is not registered: it must stop and Detach.
  kNotRegistered,
  /// The store went back and lacks what it confirmed of the robot: it must stop and Detach.
  kWentBack,
  /// The store has the robot in another fleet than its gateway: it must stop and Detach.
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
    /// From now on the robot is taken over more than kTakeoversPerMinuteMax times per minute.
    bool contested = false;
  };
  /// A new stream wants the robot, by itself or through this gateway.
  [[nodiscard]] Attached Attach(loop::StreamRef stream, SteadyTime now, SystemTime system_now,
                                std::string gateway = {});
  [[nodiscard]] Standing StandingOf(loop::StreamRef stream) const;
  /// The stream takes no more frames: the waiting one, if any, becomes the robot's. Returns the
  /// robot's stream, or none if the one that left was not it.
  loop::StreamRef Detach(loop::StreamRef stream);
  /// The current stream must stop because another process holds the robot, or the store went back.
  void Stop(Standing standing);
  /// The store does not let the stream speak for the robot: it must stop if it is current.
  void Refuse(loop::StreamRef stream);
  /// The current stream must stop on request, without a successor: kEnded, kBlocked or
  /// kDisconnected.
  void End(Standing standing);
  /// Forgets old takeovers, so that a robot that calmed down is no longer contested.
  void Sweep(SteadyTime now);

  /// The robot's stream; none if it has none.
  [[nodiscard]] loop::StreamRef current() const { return current_; }
  /// When the robot's stream, or the last one, came.
  [[nodiscard]] SystemTime connected_since() const { return connected_since_; }
  /// The gateway of that stream; empty: the robot spoke by itself, or never here.
  [[nodiscard]] const std::string& gateway() const { return gateway_; }
  /// More than kTakeoversPerMinuteMax takeovers in the last minute.
  [[nodiscard]] bool contested() const { return contested_; }

 private:
  /// True if the robot became contested by this.
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
