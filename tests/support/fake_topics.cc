#include "tests/support/fake_topics.h"

#include <algorithm>
#include <tuple>

#include "storage/remember.h"

namespace uplink::testing {

std::optional<storage::Epoch> FakeTopics::Take(const storage::TakeRequest& request,
                                               const storage::ProcessId& process,
                                               const RenewedSince& renewed_since,
                                               const DrawEpoch& draw) {
  for (const auto& [id, client] : clients_) {
    if (IsInTheWay(client.lease, request, process, renewed_since)) return std::nullopt;
  }
  for (auto& [id, client] : clients_) {
    if (!IsEndedBy(client.lease, request)) continue;
    client.lease.prefixes.clear();
    client.lease.released = true;
    client.lease.epoch = draw();
  }
  Client& client = clients_[request.client_id];
  storage::TopicLease& lease = client.lease;
  const bool held = lease.holder == process && !lease.released && lease.epoch != 0;
  lease.client_id = request.client_id;
  lease.prefixes = request.prefixes;
  std::ranges::sort(lease.prefixes);
  if (!held) {
    lease.holder = process;
    lease.released = false;
    lease.epoch = draw();
    lease.taken_at = request.at;
    const std::uint32_t kept_max = storage::DeliveriesKept(request.unacked_max);
    const storage::DeliveryMemory anew = NumberedAnew(MemoryOf(client), kept_max);
    client.deliveries.clear();
    for (const storage::Delivery& delivery : anew.known) {
      client.deliveries.emplace(delivery.number, delivery);
    }
  }
  DropOldClients();
  return lease.epoch;
}

void FakeTopics::DropOldClients() {
  std::vector<std::tuple<SystemTime, std::string>> released;
  for (const auto& [id, client] : clients_) {
    if (client.lease.released) released.emplace_back(client.lease.taken_at, id);
  }
  std::ranges::sort(released);
  for (const auto& [taken_at, id] : released) {
    if (clients_.size() <= storage::kTopicClientsMax) return;
    clients_.erase(id);
  }
}

void FakeTopics::Release(std::string_view client_id, const storage::ProcessId& process) {
  const auto client = clients_.find(client_id);
  if (client == clients_.end() || client->second.lease.holder != process) return;
  client->second.lease.released = true;
  client->second.lease.prefixes.clear();
}

std::vector<storage::TopicLease> FakeTopics::Read() const {
  std::vector<storage::TopicLease> leases;
  leases.reserve(clients_.size());
  for (const auto& [id, client] : clients_) leases.push_back(client.lease);
  return leases;
}

storage::DeliveryMemory FakeTopics::MemoryOf(std::string_view client_id) const {
  const auto client = clients_.find(client_id);
  return client == clients_.end() ? storage::DeliveryMemory() : MemoryOf(client->second);
}

storage::DeliveryMemory FakeTopics::MemoryOf(const Client& client) {
  std::vector<storage::Delivery> rows;
  rows.reserve(client.deliveries.size());
  for (const auto& [number, delivery] : client.deliveries) rows.push_back(delivery);
  return storage::MemoryOf(rows);
}

bool FakeTopics::Stands(const storage::TopicHold* hold, const storage::ProcessId& process) const {
  if (hold == nullptr) return true;
  const auto client = clients_.find(hold->client_id);
  if (client == clients_.end()) return false;
  const storage::TopicLease& lease = client->second.lease;
  return lease.epoch == hold->epoch && lease.holder == process;
}

void FakeTopics::Write(const storage::Batch& batch, const storage::ProcessId& process,
                       std::span<const storage::Outcome> outcomes) {
  const auto stands = [&](const storage::TopicHold& hold) { return Stands(&hold, process); };
  const auto changes = storage::DeliveryChangesOf(batch, outcomes, stands);
  for (const auto& [hold, delivery] : changes->added) {
    clients_.find(hold->client_id)->second.deliveries.emplace(delivery.number, delivery);
  }
  for (const auto& [hold, number] : changes->gone) {
    clients_.find(hold->client_id)->second.deliveries.erase(number);
  }
}

}  // namespace uplink::testing
