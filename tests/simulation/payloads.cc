#include "tests/simulation/payloads.h"

#include "schema/encode.h"

namespace uplink::simulation {
namespace {

model::Fault FaultOf(std::string id) {
  model::Fault fault;
  fault.unix_time_ms = 1'763'683'200'000;
  fault.fault_id = std::move(id);
  fault.source = "sim";
  fault.active = true;
  return fault;
}

}  // namespace

Payloads::Payloads() {
  const auto set = [this](Content content, std::string bytes) {
    bytes_[static_cast<std::size_t>(content)] = std::move(bytes);
  };
  model::EventTelemetry event;
  event.unix_time_ms = 1'763'683'200'000;
  model::MotionTelemetry motion;
  motion.unix_time_ms = 1'763'683'200'000;
  set(Content::kFault, schema::Encode(FaultOf("BATTERY_LOW")));
  set(Content::kEvent, schema::Encode(event));
  set(Content::kMotion, schema::Encode(motion));
  set(Content::kBadDurable, schema::Encode(FaultOf("")));
  set(Content::kBadLive, schema::Encode(motion).substr(0, 20));
  model::Fault large = FaultOf("LARGE");
  large.description = std::string(1500, 'x');
  set(Content::kLarge, schema::Encode(large));
  set(Content::kRefused, schema::Encode(FaultOf(kRefusedFaultId)));
}

}  // namespace uplink::simulation
