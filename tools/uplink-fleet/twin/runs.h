#pragma once

#include <cstddef>
#include <string>

#include "tools/uplink-fleet/twin/voice.h"

namespace uplink::synthetic {

/// The runs that a twin reports, one after the other of each kind: of its navigation, and of its
/// missions. Thread: confined to one thread.
class Runs final {
 public:
  explicit Runs(const Speech& speech) : speech_(speech) {}

  /// The next report of what it drives to.
  [[nodiscard]] Publication Navigate();
  /// The next report of its mission.
  [[nodiscard]] Publication Mission();

 private:
  struct Going {
    std::string id;
    std::size_t step = 0;
    std::size_t steps = 0;
  };

  /// Goes on with a run, or begins the next, and says so in the draft.
  [[nodiscard]] SentRun& Advance(Going& going, const char* name, Draft& draft);

  Speech speech_;
  Going navigate_;
  Going mission_;
};

}  // namespace uplink::synthetic
