#include "server/uncrew/drone_connections.h"

#include <utility>

#include "server/identity/shown_certificate.h"

namespace uplink::uncrew {

storage::ConnectionItem DroneConnections::ItemOf(const One& one) const {
  storage::ConnectionItem item;
  item.robot = one.drone->id();
  item.id = one.id;
  item.source = model::MessageSource::kUncrew;
  item.began_at = one.began_at;
  item.address = context_.connection.address();
  item.gateway = one.gateway;
  item.certificate = identity::FactsOf(context_.connection.certificate());
  item.messages = one.messages;
  item.bytes = one.bytes;
  return item;
}

void DroneConnections::Count(const fleet::RobotPtr& drone, const std::string& gateway,
                             std::size_t bytes) {
  drone->traffic.CountMessages(1);
  drone->traffic.CountBytes(bytes);
  auto found = drones_.find(drone->ruri());
  if (found == drones_.end()) {
    if (drones_.size() >= kDronesPerConnectionMax) return;
    One one;
    one.drone = drone;
    one.gateway = gateway;
    one.began_at = context_.clock.System();
    one.kept_at = context_.clock.Steady();
    one.id = context_.reports.Begin(*drone, ItemOf(one));
    found = drones_.emplace(drone->ruri(), std::move(one)).first;
  }
  One& one = found->second;
  ++one.messages;
  one.bytes += bytes;
  const SteadyTime now = context_.clock.Steady();
  if (now - one.kept_at < robot::kConnectionUpdateEvery) return;
  one.kept_at = now;
  context_.reports.Update(ItemOf(one));
}

void DroneConnections::OnConnectionEnd(transport::EndCause cause) {
  for (const auto& [ruri, one] : drones_) {
    storage::ConnectionItem item = ItemOf(one);
    item.ended = storage::ConnectionEnded{.at = context_.clock.System(),
                                          .why = transport::WhyOf(cause),
                                          .code = {},
                                          .detail = std::string(transport::SentenceOf(cause))};
    context_.reports.End(*one.drone, std::move(item));
  }
  drones_.clear();
}

}  // namespace uplink::uncrew
