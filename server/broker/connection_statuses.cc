#include "server/broker/connection_statuses.h"

namespace uplink::broker {

ConnectionStatuses::ConnectionStatuses(const std::vector<mqtt::ClientSettings>& clients) {
  statuses_.reserve(clients.size());
  for (const mqtt::ClientSettings& client : clients) {
    statuses_.push_back({.connection = static_cast<Connection>(statuses_.size()),
                         .client_id = client.client_id,
                         .client = {}});
  }
}

void ConnectionStatuses::Note(Connection connection, const mqtt::Client* client) {
  const std::lock_guard lock(mutex_);
  statuses_[static_cast<std::size_t>(connection)].client =
      client == nullptr ? mqtt::ClientStatus() : client->status();
}

std::vector<ConnectionStatus> ConnectionStatuses::Read() const {
  const std::lock_guard lock(mutex_);
  return statuses_;
}

}  // namespace uplink::broker
