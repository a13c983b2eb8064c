#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"
#include "tools/link/grpc_connection.h"
#include "uplink/v1/relay.pb.h"

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

/// An agent that keeps to the protocol: it keeps what is durable until it is acked, sends it again
/// after a break under its own number, reads everything, and comes back a second after a break.
///
/// Thread: confined to the loop's thread.
class OtherRobot final : private link::StreamEvents {
 public:
  OtherRobot(OthersWorld& world, link::Identity identity, std::size_t number);

  void SendLive();
  void SendEvent();
  /// Connects again if it is time to. Not to be called within an event.
  void Mend();
  [[nodiscard]] bool open() const { return open_; }
  /// All durable messages up to this number were acked.
  [[nodiscard]] std::uint64_t settled_seq() const { return settled_seq_; }
  [[nodiscard]] const std::string& session() const { return session_; }
  /// Moves what was sent in this window and is not acked to the tally.
  void GiveUp(std::uint64_t window, OthersTally& tally);
  [[nodiscard]] bool HasPending(std::uint64_t window) const;

 private:
  struct Pending {
    std::uint64_t seq = 0;
    SteadyTime sent;
    std::uint64_t window = 0;
  };

  void OnConnected() override;
  void OnMessage(std::string_view message) override;
  void OnSent() override {}
  void OnEnded(const link::StreamEnd& end) override;
  void Connect();
  void SendOne(std::uint64_t seq, const std::string& payload);
  void OnWelcome(const v1::Welcome& welcome);
  void OnAck(const v1::Ack& ack);

  OthersWorld& world_;
  const link::Identity identity_;
  const std::size_t number_;
  const std::string session_;
  std::unique_ptr<link::GrpcConnection> connection_;
  bool open_ = false;
  bool over_ = false;
  /// When the connection was begun, or the stream was over.
  SteadyTime since_;
  std::uint64_t last_seq_ = 0;
  std::uint64_t settled_seq_ = 0;
  std::uint64_t judged_seq_ = 0;
  std::deque<Pending> pending_;
  v1::RelayRequest frame_;
};

}  // namespace uplink::bench
