#pragma once

#include <cstdint>
#include <string>

namespace uplink::config {

/// Which new robots come in: all with a certificate, or only those that an operator added.
enum class Registration : std::uint8_t { kOpen, kClosed };
/// Which gateways may speak for robots: also those whose certificate names no robots, or only those
/// whose certificate does.
enum class Gateways : std::uint8_t { kAny, kNamed };
/// What a certificate of another fleet does: it moves its robot, or is refused.
enum class FleetMoves : std::uint8_t { kFollow, kRefuse };

struct IdentityConfig {
  Registration registration = Registration::kOpen;
  Gateways gateways = Gateways::kAny;
  FleetMoves fleet_moves = FleetMoves::kFollow;
  /// A folder of authorities with what they may vouch for (authority_folder.h); empty: none.
  std::string authorities;
  /// Empty: SavedListPath.
  std::string saved_list;
};

}  // namespace uplink::config
