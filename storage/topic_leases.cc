#include "storage/topic_leases.h"

#include <algorithm>

namespace uplink::storage {
namespace {

bool SharesPrefix(const TopicLease& lease, const TakeRequest& request) {
  return std::ranges::any_of(lease.prefixes, [&](const std::string& prefix) {
    return std::ranges::find(request.prefixes, prefix) != request.prefixes.end();
  });
}

absl::Status Bad(const std::string& text) { return absl::InvalidArgumentError(text); }

}  // namespace

absl::Status CheckRequest(const TakeRequest& request) {
  if (request.client_id.empty() || request.client_id.size() > kClientIdBytesMax) {
    return Bad("client_id has " + std::to_string(request.client_id.size()) +
               " bytes, outside 1 to " + std::to_string(kClientIdBytesMax));
  }
  if (request.prefixes.empty() || request.prefixes.size() > kLeasePrefixesMax) {
    return Bad("prefixes has " + std::to_string(request.prefixes.size()) + " items, outside 1 to " +
               std::to_string(kLeasePrefixesMax));
  }
  for (std::size_t i = 0; i < request.prefixes.size(); ++i) {
    const std::size_t bytes = request.prefixes[i].size();
    if (bytes <= kTopicPrefixBytesMax) continue;
    return Bad("prefixes[" + std::to_string(i) + "] has " + std::to_string(bytes) +
               " bytes, more than " + std::to_string(kTopicPrefixBytesMax));
  }
  std::vector<std::string> sorted = request.prefixes;
  std::ranges::sort(sorted);
  const auto twice = std::ranges::adjacent_find(sorted);
  if (twice != sorted.end()) return Bad("prefixes names \"" + *twice + "\" twice");
  if (request.unacked_max < 1 || request.unacked_max > kUnackedMaxMax) {
    return Bad("unacked_max is " + std::to_string(request.unacked_max) + ", outside 1 to " +
               std::to_string(kUnackedMaxMax));
  }
  return absl::OkStatus();
}

bool Overlaps(const TopicLease& lease, const TakeRequest& request) {
  if (lease.released) return false;
  return lease.client_id == request.client_id || SharesPrefix(lease, request);
}

bool IsInTheWay(
    const TopicLease& lease, const TakeRequest& request, const ProcessId& self,
    const std::function<bool(const ProcessId& process, std::uint64_t counter)>& renewed_since) {
  if (!Overlaps(lease, request) || lease.holder == self) return false;
  return std::ranges::none_of(request.over, [&](const OverHolder& over) {
    return over.process == lease.holder && !renewed_since(over.process, over.lease_counter);
  });
}

bool IsEndedBy(const TopicLease& lease, const TakeRequest& request) {
  return lease.client_id != request.client_id && SharesPrefix(lease, request);
}

}  // namespace uplink::storage
