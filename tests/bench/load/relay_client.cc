#include "tests/bench/load/relay_client.h"

#include <algorithm>
#include <utility>

#include "tests/bench/load/robots.h"

namespace uplink::bench {

RelayClient::RelayClient(link::Loop& loop, link::LinkOptions options, ClientStyle style)
    : style_(std::move(style)),
      connection_(loop, std::move(options), static_cast<link::StreamEvents&>(*this)) {
  connection_.Connect();
}

RelayClient::RelayClient(std::shared_ptr<link::Http2Link> gateway, std::string authority,
                         std::string ruri, ClientStyle style)
    : style_(std::move(style)),
      ruri_(std::move(ruri)),
      connection_(std::move(gateway), std::move(authority),
                  static_cast<link::StreamEvents&>(*this)) {
  connection_.Connect();
}

void RelayClient::OnConnected() {
  connection_.OpenStream(kRelayMethod);
  v1::RelayRequest frame;
  frame.mutable_hello()->set_session_id(std::string(NewSessionId().AsBytes()));
  frame.mutable_hello()->set_schema(v1::PAYLOAD_SCHEMA_ROVER_NEXUS_0_1);
  frame.mutable_hello()->set_agent_version("benchmark");
  frame.mutable_hello()->set_robot_ruri(ruri_);
  connection_.Send(frame.SerializeAsString());
}

void RelayClient::Send(std::size_t messages) {
  v1::UplinkBatch& batch = *frame_.mutable_batch();
  batch.clear_uplinks();
  for (std::size_t i = 0; i < messages; ++i) {
    v1::Uplink& uplink = *batch.add_uplinks();
    uplink.set_seq(++sent_);
    style_.write(sent_, *uplink.mutable_rover_nexus());
  }
  connection_.Send(frame_.SerializeAsString());
}

void RelayClient::OnMessage(std::string_view message) {
  if (style_.takes && style_.takes(message)) return;
  v1::RelayResponse frame;
  if (!frame.ParseFromArray(message.data(), static_cast<int>(message.size()))) {
    return Fail("a frame that cannot be read");
  }
  if (style_.receives ? frame.forward().kind() == v1::FORWARD_KIND_SNAPSHOT_END
                      : frame.has_welcome()) {
    ready_ = true;
  }
  if (frame.has_ack()) {
    acked_ =
        std::max(acked_, style_.durable ? frame.ack().through_seq() : frame.ack().judged_seq());
  }
  if (frame.has_reject()) Fail("rejected: " + frame.reject().detail());
  Moved();
}

}  // namespace uplink::bench
