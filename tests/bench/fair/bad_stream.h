#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"
#include "tools/link/grpc_connection.h"
#include "tools/link/http2_link.h"
#include "tools/link/loop.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::bench {

/// One message without its number. A value.
struct BadMessage {
  enum class Content : std::uint8_t { kRoverNexus, kRcan };
  std::string bytes;
  Content content = Content::kRoverNexus;
};

/// What the bad robot did and was answered. A value.
struct BadCounts {
  std::uint64_t connections = 0;
  std::uint64_t welcomes = 0;
  std::uint64_t messages = 0;
  std::uint64_t payload_bytes = 0;
  std::uint64_t acks = 0;
  std::uint64_t rejects = 0;
  std::uint64_t notices = 0;
  /// Streams that the server ended, by gRPC's code.
  std::map<int, std::uint64_t> ended;
  /// The server's words for the last of them.
  std::string last_end;

  /// One line.
  [[nodiscard]] std::string Text() const;
};

/// A numbering of the bad robot, which outlives its streams.
struct BadSession {
  /// 16 bytes.
  std::string id;
  /// For whom a gateway's stream speaks; empty: for the certificate's robot.
  std::string ruri;
  std::uint64_t last_seq = 0;
  /// What Acks and Rejects said so far.
  std::uint64_t settled_seq = 0;
  std::uint64_t judged_seq = 0;
};
[[nodiscard]] BadSession NewBadSession();

/// What all streams of the bad robot share; outlives them.
struct BadWorld {
  link::Loop& loop;
  const Clock& clock;
  link::LinkOptions link;
  BadCounts& counts;
};

/// One connection of the bad robot, or a part in one of a bad gateway's, and one stream after the
/// other on it. Hello goes out by itself;
/// what is owed to the protocol otherwise is its user's choice.
///
/// Errors: a connection that fails is a stream that is over.
/// Thread: confined to the loop's thread. Not to be destroyed within its own events: it tells none.
class BadStream final : private link::StreamEvents {
 public:
  enum class State : std::uint8_t { kConnecting, kGreeting, kOpen, kOver };
  /// What Hello says of Acks before: the truth, or that there were none.
  enum class Confirms : std::uint8_t { kAcks, kNothing };

  BadStream(BadWorld& world, BadSession& session, Confirms confirms);
  /// On this link, which others use too.
  BadStream(BadWorld& world, BadSession& session, std::shared_ptr<link::Http2Link> link);

  [[nodiscard]] State state() const { return state_; }
  /// When the present state began.
  [[nodiscard]] SteadyTime since() const { return since_; }
  /// The stream is over, and the connection takes another.
  [[nodiscard]] bool reusable() const {
    return state_ == State::kOver && !gone_ && connection_.usable();
  }
  /// Opens another stream on the same connection; only when reusable().
  void OpenAgain();
  /// RST_STREAM; the stream is over a little later.
  void Cancel() { connection_.CancelStream(); }
  /// A TCP reset; the stream is over.
  void Cut();
  /// Nothing is read or sent from now on, and the server is told nothing; the stream is over.
  void Freeze();
  /// Sends one frame, each message's number `step` above that before; only in kOpen.
  void Send(const std::vector<BadMessage>& messages, std::uint64_t step = 1);
  /// Bytes that the server, or the kernel, does not take yet.
  [[nodiscard]] std::size_t unsent() const { return connection_.unsent(); }
  /// Rejects that came on the present stream.
  [[nodiscard]] std::uint64_t rejects() const { return rejects_; }

 private:
  void OnConnected() override;
  void OnMessage(std::string_view message) override;
  void OnSent() override {}
  void OnEnded(const link::StreamEnd& end) override;
  void Begin();
  void Enter(State state);
  void Greet();

  BadWorld& world_;
  BadSession& session_;
  const Confirms confirms_;
  State state_ = State::kConnecting;
  SteadyTime since_;
  /// Cut or frozen by us.
  bool gone_ = false;
  std::uint64_t rejects_ = 0;
  v1::RelayRequest frame_;
  link::GrpcConnection connection_;
};

}  // namespace uplink::bench
