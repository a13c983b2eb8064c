#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "server/mqtt/end_reason.h"
#include "server/mqtt/packets.h"
#include "server/mqtt/unacked.h"

namespace uplink::mqtt {

/// A received PUBLISH. Its views are valid during the call.
struct Message {
  Publish publish;
  /// Release it once the message is settled; empty at QoS 0, and if this connection already acked
  /// it.
  std::optional<AckHandle> ack;
  /// This connection delivered it before, and `ack`, if any, is the first delivery's handle:
  /// release it once.
  bool again = false;
};

/// A connection that a broker accepted.
struct Connected {
  /// The connection's number in its handles (ConnectionNumbers).
  std::uint64_t connection = 0;
  bool session_present = false;
  /// There was a kept session that the broker no longer has: what it held for us, and what we had
  /// not acked, does not come again.
  bool session_lost = false;
};

/// Something that a broker does otherwise than we asked.
struct Trouble {
  enum class Kind : std::uint8_t {
    kFilterRefused,
    kLowerQos,
    kSessionLost,
    kSessionShort,  // the broker keeps it for less time than it was asked to
    kIdTaken,
  };
  Kind kind = Kind::kFilterRefused;
  /// For people.
  std::string text;
};

/// In the order of Trouble::Kind.
inline constexpr auto kTroubleNames = std::to_array<std::string_view>(
    {"filter_refused", "lower_qos", "session_lost", "session_short", "id_taken"});

static_assert(static_cast<std::size_t>(Trouble::Kind::kIdTaken) + 1 == kTroubleNames.size());

[[nodiscard]] constexpr std::string_view Name(Trouble::Kind kind) {
  return kTroubleNames[static_cast<std::size_t>(kind)];
}

/// Events of one connection. Thread: the client's.
class ConversationEvents {
 public:
  virtual ~ConversationEvents() = default;
  /// Before any message of the connection.
  virtual void OnConnected(const Connected& connected) = 0;
  /// All filters were answered; called again after new ones were asked for.
  virtual void OnSubscribed() = 0;
  virtual void OnMessage(const Message& message) = 0;
  /// Log it, and show it as degraded.
  virtual void OnTrouble(const Trouble& trouble) = 0;
};

/// The user of a client.
///
/// All methods of the client may be called within, except Start and the destructor.
/// Thread: all on the client's.
class ClientListener : public ConversationEvents {
 public:
  /// A connection, or an attempt, ended; the next one begins after `pause`. Not called for Stop.
  virtual void OnEnded(const End& end, milliseconds pause) = 0;
};

}  // namespace uplink::mqtt
