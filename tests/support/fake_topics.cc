#include "tests/support/fake_topics.h"

#include <algorithm>
#include <tuple>

namespace uplink::testing {

std::optional<storage::Epoch> FakeTopics::Take(const storage::TakeRequest& request,
                                               const storage::ProcessId& process,
                                               const RenewedSince& renewed_since,
                                               const DrawEpoch& draw) {
  for (const auto& [id, client] : clients_) {
    if (IsInTheWay(client.lease, request, process, renewed_since)) return std::nullopt;
  }
  for (auto& [id, client] : clients_) {
    if (!EndsWith(client.lease, request)) continue;
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
  }
  if (!client.deliveries.empty()) {
    const std::uint64_t last = client.deliveries.rbegin()->first;
    std::erase_if(client.deliveries, [&](const auto& delivery) {
      return delivery.first + request.deliveries_max <= last;
    });
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
  if (client == clients_.end()) return {};
  std::vector<storage::Delivery> rows;
  rows.reserve(client->second.deliveries.size());
  for (const auto& [number, delivery] : client->second.deliveries) rows.push_back(delivery);
  return storage::MemoryOf(rows, client->second.forget_below);
}

bool FakeTopics::Stands(const storage::TopicHoldRef& hold) const {
  if (hold == nullptr) return true;
  const auto client = clients_.find(hold->client_id);
  return client != clients_.end() && client->second.lease.epoch == hold->epoch;
}

void FakeTopics::Write(const storage::Deliveries& deliveries) {
  if (deliveries.hold == nullptr || !Stands(deliveries.hold)) return;
  Client& client = clients_.find(deliveries.hold->client_id)->second;
  client.forget_below = std::max(client.forget_below, deliveries.forget_below);
  std::erase_if(client.deliveries,
                [&](const auto& delivery) { return delivery.first < deliveries.forget_below; });
  for (const storage::Delivery& delivery : deliveries.committed) {
    client.deliveries.emplace(delivery.number, delivery);
    if (delivery.number > deliveries.kept_max) {
      client.deliveries.erase(delivery.number - deliveries.kept_max);
    }
  }
}

}  // namespace uplink::testing
