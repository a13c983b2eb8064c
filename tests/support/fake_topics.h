#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/batch.h"
#include "storage/deliveries.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/outcome.h"
#include "storage/topic_leases.h"

namespace uplink::testing {

/// The leases of topics, and what is remembered of deliveries, of a FakeDatabase. Confined to its
/// lock.
class FakeTopics final {
 public:
  using RenewedSince = std::function<bool(const storage::ProcessId&, std::uint64_t)>;
  using DrawEpoch = std::function<storage::Epoch()>;

  std::optional<storage::Epoch> Take(const storage::TakeRequest& request,
                                     const storage::ProcessId& process,
                                     const RenewedSince& renewed_since, const DrawEpoch& draw);
  void Release(std::string_view client_id, const storage::ProcessId& process);
  [[nodiscard]] std::vector<storage::TopicLease> Read() const;
  [[nodiscard]] storage::DeliveryMemory MemoryOf(std::string_view client_id) const;

  /// The process still has this lease of the client id. True for null, which needs no lease.
  [[nodiscard]] bool Stands(const storage::TopicHold* hold,
                            const storage::ProcessId& process) const;
  /// Remembers what a commit says of its deliveries, given the outcomes of its records.
  void Write(const storage::Batch& batch, const storage::ProcessId& process,
             std::span<const storage::Outcome> outcomes);

 private:
  struct Client {
    storage::TopicLease lease;
    std::map<std::uint64_t, storage::Delivery> deliveries;
  };
  [[nodiscard]] static storage::DeliveryMemory MemoryOf(const Client& client);
  void DropOldClients();

  std::map<std::string, Client, std::less<>> clients_;
};

}  // namespace uplink::testing
