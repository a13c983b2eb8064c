#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "schema/model/cyberwave/uuid.h"

namespace uplink::cyberwave {

/// What every RURI of a twin begins with. Certificates with such a RURI are refused by the relay:
/// whose these robots are says the broker.
inline constexpr std::string_view kRuriStem = "rcan://local.rcan/cyberwave/";

/// Which of a twin's two robots.
enum class RobotKind : std::uint8_t { kReal, kSimulated };

/// `rcan://local.rcan/cyberwave/twin/<id>`, of the simulated one `.../sim/<id>`; under a prefix p
/// `twin.<p>` and `sim.<p>`, with p percent-encoded. Pure.
[[nodiscard]] std::string TwinRuri(std::string_view prefix, const model::cyberwave::Uuid& twin,
                                   RobotKind kind);

/// True for a RURI that only twins may have; its shorthand must be written out before
/// (schema/rcan/ruri.h). Pure.
[[nodiscard]] bool IsTwinRuri(std::string_view ruri);

}  // namespace uplink::cyberwave
