#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/stored.h"
#include "tools/uplink-fleet/robot/account.h"
#include "uplink/v1/fleet.pb.h"

/// One robot's account against its state as the server shows it. Pure; any thread.
namespace uplink::synthetic {

/// Whether the server shows as many robots online and connected as there are. A robot whose
/// connection has just ended for its age is neither for a moment.
[[nodiscard]] bool AllThere(const std::map<std::string, v1::Robot>& live, std::size_t robots);

/// The live and latest parts that the server showed while the robot was still connected; null: it
/// was not listed.
void CompareLive(const RobotOutcome& robot, const v1::Robot* live, Findings& findings);

/// Until when the server says that the robot is parked, once its stream has ended. Nothing is
/// compared of a robot that said no Goodbye.
void CompareParked(const RobotOutcome& robot, const v1::Robot* live, Findings& findings);

/// The changes of presence within the run, while the robot was connected at its end.
void ComparePresence(const RobotOutcome& robot, const StoredRobot& stored, const Span& run,
                     Findings& findings);

/// What is wrong with changes of presence; empty: nothing. The latest up to the span's end must be
/// online and, within the span, no more than `offline_max` offline.
[[nodiscard]] std::string WrongPresence(const std::vector<v1::PresenceChange>& newest_first,
                                        const Span& run, std::uint64_t offline_max);

}  // namespace uplink::synthetic
