#include "tools/uplink-fleet/report/run_figures.h"

namespace uplink::synthetic {

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

}  // namespace uplink::synthetic
