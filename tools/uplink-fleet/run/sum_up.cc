#include "tools/uplink-fleet/run/sum_up.h"

#include <array>

namespace uplink::synthetic {
namespace {

constexpr std::array<const char*, kStatusCodes> kStatusNames = {
    "OK",        "CANCELLED",      "UNKNOWN",           "INVALID_ARGUMENT",   "DEADLINE_EXCEEDED",
    "NOT_FOUND", "ALREADY_EXISTS", "PERMISSION_DENIED", "RESOURCE_EXHAUSTED", "FAILED_PRECONDITION",
    "ABORTED",   "OUT_OF_RANGE",   "UNIMPLEMENTED",     "INTERNAL",           "UNAVAILABLE",
    "DATA_LOSS", "UNAUTHENTICATED"};

}  // namespace

void SumUp(const std::vector<RobotOutcome>& robots, Shared& shared, RunFigures& figures) {
  figures.robots = robots.size();
  for (const RobotOutcome& robot : robots) {
    figures.sent += robot.sent;
    figures.resent += robot.resent;
    figures.judged += robot.judged;
    figures.notices += robot.notices;
    figures.receivers += robot.receives ? 1 : 0;
    figures.forwarded_changes += robot.forwarded_changes;
    figures.forwarded_snapshots += robot.forwarded_snapshots;
  }
  figures.acked_durable = shared.acked_durable.load();
  figures.rejects = shared.RejectsInAll();
  figures.rejects_by_reason = RejectsByReason(shared);
  figures.only_moving = shared.only_moving.load();
  figures.welcomes = shared.welcomes.load();
  figures.breaks = shared.breaks.load();
  figures.takeovers = shared.takeovers.load();
  figures.connects = shared.connects.load();
  figures.skipped_ticks = shared.skipped_ticks.load();
  figures.drains = shared.drains.load();
  figures.first_error = shared.first_error.Read();
  for (std::size_t code = 0; code < kStatusCodes; ++code) {
    const std::uint64_t count = shared.ends[code].load();
    if (count > 0) figures.ends[kStatusNames[code]] = count;
  }
}

bool WasDisturbed(const RunFigures& figures) {
  return figures.breaks > 0 || figures.takeovers > 0 ||
         figures.ends.size() > figures.ends.count("OK") || figures.drains > 0;
}

}  // namespace uplink::synthetic
