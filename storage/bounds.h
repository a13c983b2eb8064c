#pragma once

#include <chrono>
#include <cstddef>

// How much a store keeps, and how much one call of it deletes.
namespace uplink::storage {

/// Sessions of one robot that the store keeps (protocol: Numbers).
inline constexpr std::size_t kSessionsPerRobotMax = 8;
/// Active faults of one robot that the store takes (validation rules: what is kept per robot).
inline constexpr std::size_t kActiveFaultsPerRobotMax = 10'000;
/// Shapes, and objects, of one robot that the store keeps (validation rules). Expired ones count
/// only until something needs their place.
inline constexpr std::size_t kShapesPerRobotMax = 10'000;
inline constexpr std::size_t kObjectsPerRobotMax = 10'000;
/// How long an expired shape or object can still be asked for before the sweep deletes it.
inline constexpr std::chrono::hours kExpiredKept{1};
/// Rows that one call of Store::Sweep deletes of each kind: it must not hold up a commit.
inline constexpr std::size_t kSweepRowsMax = 1'000;
/// Rows that one call of Store::Retain deletes of each kind.
inline constexpr std::size_t kRetainRowsMax = 1'000;
/// Payloads that one robot's quarantine keeps; older rows lose theirs.
inline constexpr std::size_t kQuarantinePayloadsPerRobotMax = 1'000;
/// Rows of one robot's quarantine that the store keeps, but for those that a Hello may still ask
/// for. At as many above Hello.settled_seq a stream ends: more would be read for each Welcome.
inline constexpr std::size_t kQuarantineRowsPerRobotMax = 10'000;
/// Rows that one call of Store::TrimQuarantine deletes of one robot.
inline constexpr std::size_t kTrimRowsMax = 1'000;
/// Open mission runs of one robot; one more closes the one that was reported least recently.
inline constexpr std::size_t kOpenRunsPerRobotMax = 1'000;
/// An open mission run that was not reported for so long is closed: as long as a robot may be
/// silent before it is forgotten (fleet.forget_after).
inline constexpr std::chrono::days kOpenRunAgeMax{30};
/// Ranges of skipped numbers that the store lists for one robot; the oldest go.
inline constexpr std::size_t kGapsPerRobotMax = 10'000;
/// Open requests of one drone to its operator (validation rules), and closed ones that are listed;
/// of these the oldest go.
inline constexpr std::size_t kOpenRequestsPerRobotMax = 16;
inline constexpr std::size_t kClosedRequestsPerRobotMax = 1'000;
/// Sessions of processes that are kept; the least recently used go.
inline constexpr std::size_t kServerSessionsMax = 256;

}  // namespace uplink::storage
