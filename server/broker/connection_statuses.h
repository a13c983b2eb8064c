#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "server/broker/subscriber.h"
#include "server/mqtt/settings.h"
#include "server/mqtt/status.h"

namespace uplink::broker {

/// Where a connection stands, and who it is. A value.
struct ConnectionStatus {
  Connection connection = Connection::kDurable;
  std::string client_id;
  mqtt::ClientStatus client;
};

/// Where all connections stand. Thread-safe.
class ConnectionStatuses final {
 public:
  /// In the order of cyberwave::Connection.
  explicit ConnectionStatuses(const std::vector<mqtt::ClientSettings>& clients);

  /// As it is with this client now; null: there is none.
  void Note(Connection connection, const mqtt::Client* client);
  /// Of those that there are, in their order.
  [[nodiscard]] std::vector<ConnectionStatus> Read() const;

 private:
  mutable std::mutex mutex_;
  std::vector<ConnectionStatus> statuses_;
};

}  // namespace uplink::broker
