#pragma once

#include <set>
#include <string>

#include "tools/uplink-fleet/twin/voice.h"

namespace uplink::synthetic {

/// A twin's metrics: the latest are shown, and the errors among them are faults.
/// Thread: confined to one thread.
class Metrics final {
 public:
  explicit Metrics(const Speech& speech) : speech_(speech) {}

  /// Without errors: they clear all that were named before.
  [[nodiscard]] Publication Good() { return Say({}, false); }
  /// With errors: some go on, one is new.
  [[nodiscard]] Publication WithErrors();

 private:
  [[nodiscard]] Publication Say(std::set<std::string> errors, bool one_more);

  Speech speech_;
  /// The errors that the last metrics named.
  std::set<std::string> errors_;
};

}  // namespace uplink::synthetic
