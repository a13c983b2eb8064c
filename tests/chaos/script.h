#pragma once

#include <cstdint>
#include <string>

#include "schema/model/ids.h"

namespace uplink::chaos {

/// What one message of a robot is. It follows from its number alone, so that a robot that was
/// killed says the same again, and a comparison knows what must be stored without being told.
enum class Step : std::uint8_t {
  kEvent = 0,
  kMessage = 1,
  kRaise = 2,
  kClear = 3,
  kMissionReport = 4,
  /// Broken on purpose: a row of quarantine.
  kWrong = 5,
  /// Live: no row.
  kMotion = 6,
  kNote = 7,
};
inline constexpr model::Seq kSteps = 8;

/// Numbers begin at 1.
[[nodiscard]] constexpr Step StepOf(model::Seq seq) { return static_cast<Step>(seq % kSteps); }

/// The serialized message with this number. Texts of it hold the number. Pure.
[[nodiscard]] std::string PayloadOf(model::Seq seq);

/// The session of the robot with this index, in the campaign with this seed. Pure.
[[nodiscard]] model::SessionId SessionOf(std::uint64_t seed, std::uint32_t robot);

}  // namespace uplink::chaos
