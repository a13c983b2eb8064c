#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"
#include "tools/link/grpc_connection.h"
#include "tools/uplink-fleet/robot/agent_model.h"

namespace uplink::bench {

/// What the well-behaved robots saw in one window. A value.
struct OthersTally {
  /// From the write of a durable message to its Ack, in milliseconds.
  std::vector<double> ack_ms;
  /// Durable messages that had no Ack when the wait for them was over; their age is in `ack_ms`.
  std::uint64_t unacked = 0;
  /// Streams that the server ended, or that broke.
  std::uint64_t cut = 0;
  std::uint64_t rejects = 0;
  /// Messages that left more than 100 ms late: then the load was the limit.
  std::uint64_t late = 0;
};

/// What the robots of a load share; outlives them.
struct OthersWorld {
  link::Loop& loop;
  const Clock& clock;
  link::LinkOptions link;
  /// Of the window that is measured, until its last Acks have come; else null.
  OthersTally* tally = nullptr;
  std::uint64_t tallied_window = 0;
  /// What is sent now belongs to this one; 0: to none.
  std::uint64_t window = 0;
};

/// A robot with the fleet's own agent, which sends each message in a frame of its own and comes
/// back a second after a break.
///
/// Errors: a server that breaks a rule of the protocol loses the stream, as one that ends it.
/// Thread: confined to the loop's thread.
class OtherRobot final : private link::StreamEvents {
 public:
  OtherRobot(OthersWorld& world, link::Identity identity, std::size_t number);

  void SendLive();
  void SendEvent();
  /// Connects again if it is time to. Not to be called within an event.
  void Mend();
  [[nodiscard]] bool open() const { return agent_.may_send(); }
  /// All durable messages up to this number were acked.
  [[nodiscard]] std::uint64_t settled_seq() const { return agent_.settled_seq(); }
  [[nodiscard]] const model::SessionId& session() const { return agent_.session(); }
  /// Something of the tallied window has no Ack.
  [[nodiscard]] bool pending() const { return !pending_.empty(); }
  /// Moves what was sent in the tallied window and has no Ack to the tally.
  void GiveUp();

 private:
  void OnConnected() override;
  void OnMessage(std::string_view message) override;
  void OnSent() override {}
  void OnEnded(const link::StreamEnd& end) override;
  void Connect();
  void Send(synthetic::Keeping keeping, std::string payload);
  void Pump();

  OthersWorld& world_;
  const link::Identity identity_;
  const std::size_t number_;
  synthetic::AgentModel agent_;
  std::unique_ptr<link::GrpcConnection> connection_;
  bool over_ = false;
  /// When the connection was begun, or the stream was over.
  SteadyTime since_;
  std::uint64_t events_ = 0;
  /// When those of the tallied window were sent that have no Ack.
  std::multiset<SteadyTime> pending_;
};

}  // namespace uplink::bench
