#pragma once

#include <string>
#include <string_view>

#include "tools/uplink-fleet/twin/voice.h"

namespace uplink::synthetic {

/// One row of the table.
struct Happening;

/// What happens to a twin once and is stored: events, log lines, the marks of its clients, and
/// changes of its environment; by a table of its messages. All at QoS 1, each with a mark. Thread:
/// confined to one thread.
class Happenings final {
 public:
  explicit Happenings(const Speech& speech) : speech_(speech) {}

  [[nodiscard]] Publication Next();
  /// A mark of that client's session: connected, telemetry_start, telemetry_end, disconnected.
  [[nodiscard]] Publication Mark(Speaker speaker, std::string_view type);

 private:
  [[nodiscard]] Publication Say(const Happening& what);
  void Expect(const Happening& what, const Draft& draft);

  Speech speech_;
};

}  // namespace uplink::synthetic
