#pragma once

#include <cstddef>
#include <cstdint>

#include "schema/base/clock.h"
#include "server/session/attachment.h"
#include "server/session/context.h"
#include "server/session/read_gate.h"
#include "server/transport/end_cause.h"
#include "server/transport/peer_connection.h"
#include "storage/connection.h"

namespace uplink::session {

/// Reports one stream as a connection of its robot: once the store is asked to open it, which gives
/// a new robot its row, each kConnectionUpdateEvery while it brings messages, and when it ends.
/// Confined to the stream's thread.
class StreamReport final {
 public:
  /// All of them outlive it.
  struct Sources {
    const SessionContext& context;
    Attachment& robot;
    const ReadGate& reading;
    /// Null: where the stream comes from is unknown.
    const transport::PeerConnection* connection = nullptr;
  };
  explicit StreamReport(const Sources& sources) : sources_(sources) {}

  /// Attachment::Open has asked the store.
  void Begin(SteadyTime now);
  void CountFrame(std::size_t bytes);
  /// Of a stream that has its robot.
  void CountMessages(std::size_t messages, SteadyTime now);
  /// The stream has ended, and no longer has its robot. Does nothing unless it began.
  void End(const transport::Ending& ending);

 private:
  [[nodiscard]] storage::ConnectionItem Item() const;

  const Sources sources_;
  bool began_ = false;
  storage::ConnectionId id_{};
  SystemTime began_at_;
  SteadyTime kept_at_;
  std::uint64_t messages_ = 0;
  std::uint64_t bytes_ = 0;
};

}  // namespace uplink::session
