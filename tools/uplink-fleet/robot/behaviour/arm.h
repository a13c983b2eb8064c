#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "schema/model/rcan.h"
#include "tools/uplink-fleet/robot/behaviour/facts.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

inline constexpr std::size_t kArmJoints = 6;

/// An arm of six joints that swing each at their own pace; the last one lifts. They stand
/// still in an emergency stop. Position, velocity and effort fit each other. Reported as RCAN's
/// Robot State. Confined to one thread.
class Arm final {
 public:
  explicit Arm(Seeded random);

  void Advance(const Moment& moment, const Facts& facts);
  /// The next state: its number follows, its time is after that of the one before.
  [[nodiscard]] model::RcanState State(const Moment& moment, const Facts& facts);

 private:
  struct Swing {
    double amplitude = 0;
    double radians_per_s = 0;
    double phase = 0;
  };
  [[nodiscard]] model::RcanJoint Joint(std::size_t index, bool moves) const;

  std::array<Swing, kArmJoints> swings_;
  double moved_s_ = 0;
  double up_s_ = 0;
  std::int64_t seq_ = 0;
  std::int64_t last_us_ = 0;
};

}  // namespace uplink::synthetic
