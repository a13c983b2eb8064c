#pragma once

#include <cstddef>
#include <string>

#include "tools/uplink-fleet/twin/voice.h"

namespace uplink::synthetic {

/// Messages that are wrong on purpose: one after the other, at least one for each reason that a
/// message is rejected for but its rate. Thread: confined to one thread.
/// Source: docs/integrate/cyberwave.md and the vendor's topics.
class Wrongs final {
 public:
  explicit Wrongs(const Speech& speech) : speech_(speech) {}

  [[nodiscard]] Publication Next();

 private:
  [[nodiscard]] Publication Make(std::size_t kind);

  Speech speech_;
  std::size_t next_ = 0;
};

}  // namespace uplink::synthetic
