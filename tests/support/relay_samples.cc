#include "tests/support/relay_samples.h"

#include <array>

#include "schema/encode.h"

namespace uplink::testing {

v1::RelayRequest HelloFrame(const model::SessionId& session, model::Seq settled,
                            model::Seq judged) {
  v1::RelayRequest frame;
  v1::Hello& hello = *frame.mutable_hello();
  hello.set_session_id(std::string(session.AsBytes()));
  hello.set_settled_seq(settled);
  hello.set_judged_seq(judged);
  hello.set_schema(v1::PAYLOAD_SCHEMA_ROVER_NEXUS_0_1);
  hello.set_agent_version("test agent");
  return frame;
}

v1::RelayRequest BatchFrame(const std::vector<Sent>& messages) {
  v1::RelayRequest frame;
  v1::UplinkBatch& batch = *frame.mutable_batch();
  for (const Sent& message : messages) {
    v1::Uplink& uplink = *batch.add_uplinks();
    uplink.set_seq(message.seq);
    uplink.set_rover_nexus(message.payload);
  }
  return frame;
}

std::string FaultPayload(const std::string& fault_id) {
  model::Fault fault;
  fault.unix_time_ms = 1'763'683'200'000;
  fault.fault_id = fault_id;
  fault.source = "drive";
  fault.severity = model::FaultSeverity::kMajor;
  fault.active = true;
  fault.category = "motor";
  fault.description = "a motor is hot";
  return schema::Encode(fault);
}

std::string MotionPayload(double lat_deg) {
  model::MotionTelemetry motion;
  motion.unix_time_ms = 1'763'683'200'000;
  motion.pose = model::Pose{.lat_deg = lat_deg, .lon_deg = 13.4};
  motion.velocity = model::VelTwist{.linear_mps = 1.0F, .angular_rps = 0.0F};
  return schema::Encode(motion);
}

model::SessionId SessionOf(std::uint8_t number) {
  std::array<std::uint8_t, model::SessionId::kBytes> bytes{};
  bytes.back() = number;
  return model::SessionId(bytes);
}

std::string RuriOf(int number) {
  return "rcan://example.org/acme/rover/r" + std::to_string(number);
}

}  // namespace uplink::testing
