#pragma once

#include <vector>

#include "schema/model/spatial.h"
#include "tools/uplink-fleet/robot/behaviour/facts.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

/// Metres of a degree of latitude (the mean of the WGS 84 ellipsoid).
inline constexpr double kMetresADegree = 111'320;

/// A position `east_m` and `north_m` from `origin`, on a plane that touches there: good for the few
/// hundred metres that a robot moves in.
[[nodiscard]] model::GeoPoint2 Offset(const model::GeoPoint2& origin, double east_m,
                                      double north_m);

/// A closed route of waypoints that is driven round and round: the robot speeds up, turns as fast
/// as it can, and goes where it points to, so that position, heading and speed fit each other.
/// Confined to one thread, as every behaviour.
class Route final {
 public:
  explicit Route(Seeded random);

  void Advance(const Moment& moment, Facts& facts);
  [[nodiscard]] model::MotionTelemetry Motion(const Moment& moment, const Facts& facts) const;
  /// The waypoints from the next one on, once round.
  [[nodiscard]] model::Positions Ahead() const;
  [[nodiscard]] const model::GeoPoint2& origin() const { return origin_; }

 private:
  struct Point {
    double east_m = 0;
    double north_m = 0;
  };

  model::GeoPoint2 origin_;
  std::vector<Point> waypoints_;
  std::size_t next_ = 0;
  Point at_;
  double heading_rad_ = 0;
  double cruise_mps_ = 1;
  double altitude_m_ = 0;
};

}  // namespace uplink::synthetic
