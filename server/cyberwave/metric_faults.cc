#include "server/cyberwave/metric_faults.h"

#include <utility>

#include <fmt/format.h>

#include "schema/base/utf8.h"
#include "schema/limits.h"
#include "server/cyberwave/held_bytes.h"

namespace uplink::cyberwave {
namespace {

constexpr std::string_view kCategory = "metrics";
/// Of a set, with its text.
constexpr std::size_t kSetNodeBytes = 32 + sizeof(std::string) + kAllocationBytes;

/// FNV-1a: the same on every machine. Collisions do not matter: a sender of two texts that collide
/// could as well send one text twice.
std::uint64_t NumberOf(std::string_view text) {
  constexpr std::uint64_t kBasis = 0xcbf29ce484222325U;
  constexpr std::uint64_t kPrime = 0x100000001b3U;
  std::uint64_t number = kBasis;
  for (const char c : text) {
    number ^= static_cast<unsigned char>(c);
    number *= kPrime;
  }
  return number;
}

model::Fault FaultOf(std::string id, std::int64_t unix_time_ms) {
  model::Fault fault;
  fault.unix_time_ms = unix_time_ms;
  fault.fault_id = std::move(id);
  fault.source = kMetricFaultSource;
  fault.severity = model::FaultSeverity::kMajor;
  fault.category = kCategory;
  return fault;
}

}  // namespace

std::string FaultIdOf(std::string_view error) {
  if (error.size() <= schema::kIdBytesMax) return std::string(error);
  const std::string number = fmt::format("~{:016x}", NumberOf(error));
  return std::string(Utf8Prefix(error, schema::kIdBytesMax - number.size())) + number;
}

std::vector<model::Fault> MetricFaults::Take(const std::vector<std::string>& errors,
                                             std::int64_t unix_time_ms) {
  std::vector<model::Fault> changes;
  std::set<std::string, std::less<>> named;
  for (const std::string& error : errors) {
    if (named.size() >= kMetricFaultsMax) break;
    const auto [id, first] = named.insert(FaultIdOf(error));
    if (!first || active_.contains(*id)) continue;
    model::Fault fault = FaultOf(*id, unix_time_ms);
    fault.active = true;
    fault.description = error;
    changes.push_back(std::move(fault));
  }
  for (const std::string& id : active_) {
    if (!named.contains(id)) changes.push_back(FaultOf(id, unix_time_ms));
  }
  active_ = std::move(named);
  return changes;
}

std::size_t MetricFaults::CountChanges(const std::vector<std::string>& errors) const {
  std::set<std::string, std::less<>> named;
  std::size_t stay = 0;
  for (const std::string& error : errors) {
    if (named.size() >= kMetricFaultsMax) break;
    const auto [id, first] = named.insert(FaultIdOf(error));
    if (first && active_.contains(*id)) ++stay;
  }
  return (named.size() - stay) + (active_.size() - stay);
}

void MetricFaults::Restore(const std::vector<std::string>& fault_ids) {
  active_.clear();
  for (const std::string& id : fault_ids) {
    if (active_.size() >= kMetricFaultsMax) return;
    active_.insert(id);
  }
}

std::size_t HeldBytes(const MetricFaults& faults) {
  std::size_t held = 0;
  for (const std::string& id : faults.active()) held += kSetNodeBytes + HeldBytes(id);
  return held;
}

}  // namespace uplink::cyberwave
