#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schema/model/fault.h"
#include "schema/model/ids.h"
#include "schema/model/motion.h"
#include "schema/model/rejection.h"
#include "schema/model/status.h"

namespace uplink::synthetic {

/// Reports that one robot remembers for the comparison at the end; at it the robot raises no more.
inline constexpr std::size_t kReportsMax = 200'000;

/// A fault that was reported, and whether an Ack covered it.
struct FaultReport {
  model::Fault fault;
  bool acked = false;
};

/// A message that is wrong on purpose, and what the server must say of it.
struct WrongReport {
  model::RejectReason reason = model::RejectReason::kMalformed;
  std::string field;
  model::Seq seq = 0;
  bool acked = false;
  /// The Reject that came before the Ack.
  std::optional<model::Rejection> told;
};

/// Everything that one robot reported and learned: what the server and its store are held against.
/// A value; written by the robot's thread, read when that has ended.
struct Ledger {
  /// By description, which is unique in the run.
  std::map<std::string, FaultReport> faults;
  /// By the tag of the message.
  std::map<std::uint64_t, WrongReport> wrongs;
  /// Tag of a fault's message to its description, until it is settled.
  std::map<std::uint64_t, std::string> open_faults;
  /// Faults that a robot took back by now are not here: (fault id, source) of those that are
  /// active.
  std::map<std::pair<std::string, std::string>, std::string> active;
  std::optional<model::MotionTelemetry> last_motion;
  std::optional<model::StatusTelemetry> last_status;
  std::uint64_t live_offered = 0;
  /// Faults that were answered with a Reject; none should be.
  std::uint64_t faults_rejected = 0;
  std::string first_fault_rejection;
};

/// One robot's part of the run, after it has ended.
struct RobotOutcome {
  std::string ruri;
  std::string session_hex;
  Ledger ledger;
  std::uint64_t last_seq = 0;
  std::uint64_t sent = 0;
  std::uint64_t resent = 0;
  std::uint64_t live_dropped = 0;
  std::uint64_t notices = 0;
  bool all_settled = false;
  bool ended_ok = false;
};

}  // namespace uplink::synthetic
