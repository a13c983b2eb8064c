#include "server/broker/connection_log.h"

#include <utility>

namespace uplink::broker {

ConnectionLog::ConnectionLog(log::Logger& logger, const Clock& clock, std::string broker)
    : logger_(logger), clock_(clock), broker_(std::move(broker)), ends_(logger) {}

void ConnectionLog::Connected(Connection connection, const mqtt::Connected& connected) {
  logger_.Info("mqtt_connected", {{"connection", Name(connection)},
                                  {"broker", broker_},
                                  {"session_present", connected.session_present}});
}

void ConnectionLog::Subscribed(Connection connection) {
  logger_.Info("mqtt_subscribed", {{"connection", Name(connection)}});
}

void ConnectionLog::Trouble(Connection connection, const mqtt::Trouble& trouble) {
  if (trouble.kind == mqtt::Trouble::Kind::kSessionLost) {
    const std::lock_guard lock(mutex_);
    session_lost_at_ = clock_.System();
  }
  logger_.Warn("mqtt_trouble", {{"connection", Name(connection)},
                                {"broker", broker_},
                                {"what", mqtt::Name(trouble.kind)},
                                {"why", trouble.text}});
}

void ConnectionLog::Ended(Connection connection, const mqtt::End& end) {
  ends_.Write(log::Level::kWarn, "mqtt_disconnected",
              {{"connection", Name(connection)},
               {"broker", broker_},
               {"reason", Name(end.reason)},
               {"why", end.text}});
}

}  // namespace uplink::broker
