#pragma once

#include <cstdint>
#include <string>

#include "tools/uplink-fleet/ledger.h"
#include "tools/uplink-fleet/stored_robot.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// What comparing one robot's rows found. Sums over robots. A value.
struct RowCounts {
  /// Fault reports: acked by the fleet, found in the store, equal in content.
  std::uint64_t faults_acked = 0;
  std::uint64_t faults_stored = 0;
  std::uint64_t faults_equal = 0;
  std::uint64_t faults_missing = 0;
  std::uint64_t faults_doubled = 0;
  /// Rows of this run that the robot never reported.
  std::uint64_t faults_foreign = 0;
  /// Active set.
  std::uint64_t active_expected = 0;
  std::uint64_t active_stored = 0;
  std::uint64_t active_wrong = 0;
  /// Wrong on purpose: acked, told by an equal Reject before the Ack, equal row in quarantine.
  std::uint64_t wrongs_acked = 0;
  std::uint64_t wrongs_told = 0;
  std::uint64_t wrongs_stored = 0;
  /// Rows in quarantine of this session that are doubled, foreign, or say something else.
  std::uint64_t quarantine_bad = 0;
  std::uint64_t gaps = 0;
  /// First difference in words.
  std::string first_difference;

  void Add(const RowCounts& other);
};

/// Compares one robot's ledger with its rows; `run` parts them from rows of other runs.
[[nodiscard]] RowCounts CompareRows(const RobotOutcome& robot, const StoredRobot& stored,
                                    const std::string& run);

/// What the live parts of the server say that the robot did not say last; empty if they agree.
[[nodiscard]] std::string CompareLive(const RobotOutcome& robot, const v1::Robot& live);

}  // namespace uplink::synthetic
