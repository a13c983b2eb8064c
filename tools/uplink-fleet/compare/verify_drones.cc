#include "tools/uplink-fleet/compare/verify_drones.h"

#include <optional>
#include <string>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

std::string Text(std::uint64_t number) { return fmt::format("{}", number); }

}  // namespace

void DroneTotals::Add(const DroneAccount& account) {
  ++drones;
  if (account.waiting() == 0) ++settled_drones;
  taken += account.answered();
  wrongs += account.wrongs();
}

std::vector<CheckRow> VerifyDrones(const DroneEvidence& evidence) {
  const DroneTotals& totals = evidence.totals;
  std::vector<CheckRow> rows;
  rows.push_back({"drones with all answered", Text(totals.drones), Text(totals.settled_drones), "",
                  totals.settled_drones == totals.drones, ""});
  CheckCounts(evidence, rows);
  if (const std::optional<Conservation> moved = evidence.Moved()) {
    // After a restart the counters know a part alone. A call that was given up may have arrived.
    const bool within = totals.answered <= moved->received && moved->received <= totals.sent;
    rows.push_back({"received, from calls answered to calls sent",
                    fmt::format("{}-{}", totals.answered, totals.sent), Text(moved->received), "",
                    evidence.restarted || within, ""});
    rows.push_back({"rejected, each wrong sample once", Text(totals.wrongs),
                    Text(moved->Of("rejected")), "",
                    evidence.restarted || moved->Of("rejected") == totals.wrongs, ""});
  }
  rows.push_back({"drones whose rows were read", Text(totals.drones), "",
                  Text(evidence.drones_read), evidence.drones_read == totals.drones, ""});
  for (std::size_t i = kDroneThings; i < kThings; ++i) {
    rows.push_back(LineOf(static_cast<Thing>(i), evidence.findings));
  }
  return rows;
}

}  // namespace uplink::synthetic
