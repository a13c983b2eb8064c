#pragma once

#include "tools/uplink-fleet/twin/speech.h"

namespace uplink::synthetic {

/// Where a twin is: position, rotation, scale, GPS; also what is only wanted, and what comes late.
/// Thread: confined to one thread.
class Poses final {
 public:
  explicit Poses(const Speech& speech) : speech_(speech) {}

  [[nodiscard]] Publication Position();
  [[nodiscard]] Publication SimulatedPosition();
  [[nodiscard]] Publication Rotation();
  [[nodiscard]] Publication SimulatedRotation();
  [[nodiscard]] Publication Scale();
  [[nodiscard]] Publication Gps();
  /// Older than a position that was published: superseded.
  [[nodiscard]] Publication LatePosition();
  /// How somebody wants it to be: counted alone.
  [[nodiscard]] Publication WantedPosition();

 private:
  [[nodiscard]] boost::json::object Place();
  /// Notes a live value of that side, and that it is a sign of life.
  void Say(Side side, const Draft& draft, const char* path, const boost::json::object& fields,
           std::string_view source);

  Speech speech_;
};

}  // namespace uplink::synthetic
