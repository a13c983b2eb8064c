#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::bench {

/// What the bad robot, or gateway, does to its server.
enum class Misdeed : std::uint8_t {
  kShapes,
  kTexts,
  kControls,
  kMalformed,
  kRejects,
  kTakeover,
  kExtras,
  kJoints,
  kGaps,
  kMute,
  kGateway,
};

/// In the order of a whole run.
inline constexpr std::array kMisdeeds = {
    Misdeed::kShapes,  Misdeed::kTexts,    Misdeed::kControls, Misdeed::kMalformed,
    Misdeed::kRejects, Misdeed::kTakeover, Misdeed::kExtras,   Misdeed::kJoints,
    Misdeed::kGaps,    Misdeed::kMute,     Misdeed::kGateway,
};

/// The scenario's name: `shapes`.
[[nodiscard]] std::string NameOf(Misdeed misdeed);
/// What it is, in a line for people.
[[nodiscard]] std::string_view AboutOf(Misdeed misdeed);
[[nodiscard]] std::optional<Misdeed> MisdeedOf(std::string_view name);

}  // namespace uplink::bench
