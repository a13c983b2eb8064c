#pragma once

#include <cstdint>
#include <random>

#include "tools/uplink-fleet/scenario/scenario.h"

namespace uplink::synthetic {

/// What the scenario does to a robot's connection.
enum class Mishap : std::uint8_t { kNone, kCut, kBreak, kHalfOpen, kTakeover };

/// What happens in one tick of this phase, by chance. Draws one number, whatever it gives: the same
/// seed gives the same network.
[[nodiscard]] Mishap DrawMishap(const Phase& phase, std::mt19937_64& random);

}  // namespace uplink::synthetic
