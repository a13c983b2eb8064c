#pragma once

#include <cstdint>
#include <string>

#include "schema/model/ids.h"
#include "server/identity/fleet_bounds.h"

namespace uplink::fleet {

/// By which certificate a stream speaks for a robot. A closed list.
enum class Grant : std::uint8_t {
  /// The certificate is the robot's own.
  kOwn,
  /// A gateway's certificate names the robot.
  kNamed,
  /// A gateway's certificate names no robot: it may speak for all robots of its fleet.
  kFleet,
};

/// The robot that a stream claims to speak for. A value.
struct Claim {
  /// With the fleet of the certificate.
  model::RobotId robot;
  Grant grant = Grant::kOwn;
  /// The subject of the gateway's certificate; empty: the robot speaks by itself.
  std::string gateway = {};
  /// Its authority may move the robot out of these fleets alone.
  identity::FleetBoundsPtr bounds = {};
};

/// Why a claim is refused. A closed list.
enum class Refusal : std::uint8_t {
  kNone,
  /// limits.robots_max.
  kFull,
  /// The gateway brought in as many robots as one may (GatewayRobots).
  kGatewayFull,
  /// The robot is of another fleet than the gateway, whose certificate does not name it.
  kOtherFleet,
  /// The fleet's name holds an invisible character, and the store has no robot of that fleet
  /// (OddFleets).
  kOddFleet,
  /// The same, but the store was not read yet: it may have such a robot.
  kFleetsUnread,
  // Of Entry; StatusOfEntry says them.
  /// An operator blocked the robot.
  kBlocked,
  /// It is new, and no operator added it.
  kNotRegistered,
  /// A gateway's certificate names no robots.
  kGatewayUnnamed,
  /// The certificate is of another fleet than the robot, and does not move it.
  kFleetStays,
  /// The certificate's authority may not vouch for the fleet that the robot is in.
  kAuthorityOutside,
  /// It is new, and its RURI is not in the one form that new robots have (identity::FlawOfForm).
  kNotCanonical,
  /// The same, but the store was not read yet: it may have such a robot.
  kRobotsUnread,
};

}  // namespace uplink::fleet
