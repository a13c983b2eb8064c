#include "server/view/drone_json.h"

#include <memory>
#include <string>

#include "schema/json/uncrew.h"
#include "server/view/json.h"

namespace uplink::view {

boost::json::object DroneJson(const uncrew::LiveSamples& live) {
  boost::json::object object;
  for (const model::uncrew::TypeRow& row : model::uncrew::kTypeRows) {
    boost::json::object by_key;
    for (const uncrew::LiveSample& sample : live.Of(row.type)) {
      boost::json::object shown = json::Render(
          sample.value,
          {.sampled_at_us = sample.metadata.sampled_at_us, .received_at = sample.received});
      if (sample.key) {
        by_key[std::to_string(*sample.key)] = std::move(shown);
      } else {
        by_key = std::move(shown);
      }
    }
    if (!live.Of(row.type).empty())
      object[boost::json::string_view(row.name.data(), row.name.size())] = std::move(by_key);
  }
  return object;
}

std::size_t CopyDrone(const uncrew::Drones* drones, bool with_parts, RobotView& robot) {
  const uncrew::DronePtr drone = drones == nullptr ? nullptr : drones->Find(robot.id.ruri);
  if (drone == nullptr) return 0;
  if (robot.state.foreign) return 0;
  std::size_t bytes = 0;
  drone->LookAt([&](const uncrew::LiveSamples& live) {
    // The list is empty if the drone's state was dropped and it has not called since.
    robot.calls_here = !live.Of(model::uncrew::SampleType::kOperatorRequests).empty();
    robot.operator_requests_open = live.requests().size();
    if (!with_parts) return;
    robot.drone = std::make_shared<const uncrew::LiveSamples>(live);
    bytes = live.bytes();
  });
  return bytes;
}

}  // namespace uplink::view
