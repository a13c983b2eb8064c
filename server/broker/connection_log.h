#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "schema/base/clock.h"
#include "server/broker/subscriber.h"
#include "server/log/logger.h"
#include "server/log/rate_limited.h"
#include "server/mqtt/client.h"

namespace uplink::broker {

/// Logs what happens to the connections to the broker, and keeps when the broker was last found to
/// have lost our session.
///
/// Thread:  confined to the connections'; session_lost_at any.
class ConnectionLog final {
 public:
  /// The references outlive it. `broker` names the broker.
  ConnectionLog(log::Logger& logger, const Clock& clock, std::string broker);

  void Connected(Connection connection, const mqtt::Connected& connected);
  void Subscribed(Connection connection);
  void Trouble(Connection connection, const mqtt::Trouble& trouble);
  void Ended(Connection connection, const mqtt::End& end);

  [[nodiscard]] std::optional<SystemTime> session_lost_at() const {
    const std::lock_guard lock(mutex_);
    return session_lost_at_;
  }

 private:
  log::Logger& logger_;
  const Clock& clock_;
  const std::string broker_;
  /// For a broker that ends connections again and again.
  log::RateLimited ends_;
  mutable std::mutex mutex_;
  std::optional<SystemTime> session_lost_at_;
};

}  // namespace uplink::broker
