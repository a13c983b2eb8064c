#include "server/broker/pongs.h"

#include <string>

#include "schema/cyberwave/pong.h"

namespace uplink::broker {

void Pongs::Answer(const cyberwave::Topic& ping, std::string_view correlation,
                   const cyberwave::Arrival& arrived) {
  const std::string topic = cyberwave::PongTopic(ping);
  const bool answered = limit_.Take(topic, arrived.steady) &&
                        publish_({.topic = topic,
                                  .payload = cyberwave::PongPayload(arrived.system),
                                  .correlation = std::string(correlation)});
  (answered ? probe_.pongs : probe_.pongs_withheld).Add();
}

}  // namespace uplink::broker
