#pragma once

#include <cstddef>

#include "tools/uplink-fleet/drone/voice.h"

namespace uplink::synthetic {

/// Samples that are wrong on purpose: one kind after the other, each with the reason and the field
/// that the server must name. Thread: confined to one thread.
class DroneWrongs final {
 public:
  DroneWrongs(const DroneSpeech& speech, std::size_t line)
      : speech_(speech), line_(line), chance_(speech.voice.ChanceOf(line)) {}

  [[nodiscard]] AvatarCall Next();
  [[nodiscard]] std::size_t line() const { return line_; }

 private:
  DroneSpeech speech_;
  const std::size_t line_;
  Seeded chance_;
  std::size_t next_ = 0;
};

/// How many kinds there are.
[[nodiscard]] std::size_t DroneWrongKinds();

}  // namespace uplink::synthetic
