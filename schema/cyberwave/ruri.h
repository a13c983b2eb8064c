#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "schema/model/cyberwave/uuid.h"

namespace uplink::cyberwave {

/// What every RURI of a twin begins with. The relay refuses certificates with such a RURI: only the
/// broker may speak for these robots.
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
