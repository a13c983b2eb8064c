#include "tools/uplink-fleet/report/run_figures.h"

namespace uplink::synthetic {

namespace {

constexpr std::array<const char*, kStatusCodes> kStatusNames = {
    "OK",        "CANCELLED",      "UNKNOWN",           "INVALID_ARGUMENT",   "DEADLINE_EXCEEDED",
    "NOT_FOUND", "ALREADY_EXISTS", "PERMISSION_DENIED", "RESOURCE_EXHAUSTED", "FAILED_PRECONDITION",
    "ABORTED",   "OUT_OF_RANGE",   "UNIMPLEMENTED",     "INTERNAL",           "UNAVAILABLE",
    "DATA_LOSS", "UNAUTHENTICATED"};

/// By reason as JSON spells it; `unknown` for reasons that this program does not know.
std::map<std::string, std::uint64_t> RejectsByReason(const Shared& shared) {
  std::map<std::string, std::uint64_t> counts;
  for (std::size_t index = 0; index < shared.rejects.size(); ++index) {
    const std::uint64_t count = shared.rejects[index].load();
    if (count == 0) continue;
    const bool known = index > 0 && index <= model::kRejectReasons;
    const auto reason = static_cast<model::RejectReason>(index);
    counts[known ? std::string(model::ToText(reason)) : "unknown"] += count;
  }
  return counts;
}

}  // namespace

RunFigures SumUp(const std::vector<RobotOutcome>& robots, const Shared& shared) {
  RunFigures figures;
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
  return figures;
}

bool WasDisturbed(const RunFigures& figures) {
  return figures.breaks > 0 || figures.takeovers > 0 ||
         figures.ends.size() > figures.ends.count("OK") || figures.drains > 0;
}

}  // namespace uplink::synthetic
