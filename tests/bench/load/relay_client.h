#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "tests/bench/load/client.h"
#include "tools/link/grpc_connection.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::bench {

/// A robot as uplinkd and the bare gRPC sink know it. It keeps nothing and never resumes, so that a
/// message costs the load's core as little as it can; what keeps to the protocol is the fleet's
/// agent.
class RelayClient final : public Client, private link::StreamEvents {
 public:
  RelayClient(link::Loop& loop, link::LinkOptions options, ClientStyle style);
  /// The robot of this address, through a gateway's connection.
  RelayClient(std::shared_ptr<link::Http2Link> gateway, std::string authority, std::string ruri,
              ClientStyle style);

  void Send(std::size_t messages) override;
  [[nodiscard]] std::size_t unsent() const override { return connection_.unsent(); }

 private:
  void OnConnected() override;
  void OnMessage(std::string_view message) override;
  void OnSent() override { Moved(); }
  void OnEnded(const link::StreamEnd& end) override { Fail(end.message); }

  const ClientStyle style_;
  /// Hello.robot_ruri.
  const std::string ruri_;
  v1::RelayRequest frame_;
  link::GrpcConnection connection_;
};

}  // namespace uplink::bench
