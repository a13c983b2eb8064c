#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "storage/leases.h"

namespace uplink::testing {

/// The leases of the processes that share a fake database. Confined to its lock.
class FakeLeaseTable final {
 public:
  void Renew(const storage::ProcessId& process, const storage::ProcessCard& card) {
    storage::Lease& lease = leases_[process];
    lease = {process, card, lease.counter + 1, lease.released};
  }
  void Release(const storage::ProcessId& process) {
    const auto lease = leases_.find(process);
    if (lease != leases_.end()) lease->second.released = true;
  }
  [[nodiscard]] std::vector<storage::Lease> Read() const {
    std::vector<storage::Lease> leases;
    for (const auto& [process, lease] : leases_) leases.push_back(lease);
    return leases;
  }
  /// It does not stand at `counter` any more: it was raised since, or the store went back.
  [[nodiscard]] bool RenewedSince(const storage::ProcessId& process, std::uint64_t counter) const {
    const auto lease = leases_.find(process);
    return lease != leases_.end() && lease->second.counter != counter;
  }
  /// It is there, and was not released.
  [[nodiscard]] bool Stands(const storage::ProcessId& process) const {
    const auto lease = leases_.find(process);
    return lease != leases_.end() && !lease->second.released;
  }

 private:
  std::map<storage::ProcessId, storage::Lease> leases_;
};

}  // namespace uplink::testing
