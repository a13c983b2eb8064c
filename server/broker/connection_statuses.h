#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "server/broker/subscriber.h"
#include "server/mqtt/settings.h"
#include "server/mqtt/status.h"

namespace uplink::broker {

/// The state of a connection. A value.
struct ConnectionStatus {
  Connection connection = Connection::kDurable;
  std::string client_id;
  mqtt::ClientStatus client;
};

/// The state of all connections. Thread-safe.
class ConnectionStatuses final {
 public:
  /// In the order of cyberwave::Connection.
  explicit ConnectionStatuses(const std::vector<mqtt::ClientSettings>& clients);

  /// Reads the state of this client; null if the connection has none.
  void Note(Connection connection, const mqtt::Client* client);
  /// Of the connections that exist, in the order of cyberwave::Connection.
  [[nodiscard]] std::vector<ConnectionStatus> Read() const;

 private:
  mutable std::mutex mutex_;
  std::vector<ConnectionStatus> statuses_;
};

}  // namespace uplink::broker
