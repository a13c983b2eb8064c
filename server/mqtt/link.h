#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "server/mqtt/end_reason.h"
#include "server/mqtt/secrets.h"
#include "server/mqtt/settings.h"

namespace uplink::mqtt {

/// What is under way before a connection is up, in this order.
enum class LinkPhase : std::uint8_t { kResolving, kConnecting, kHandshaking };

/// Whoever has a link. Thread: all on the link's, and never from within a method of the link.
class LinkEvents {
 public:
  virtual ~LinkEvents() = default;
  virtual void OnPhase(LinkPhase phase) = 0;
  virtual void OnUp() = 0;
  /// input() has bytes.
  virtual void OnRead() = 0;
  virtual void OnWritten() = 0;
  /// The time of WakeAt came; it may also come for an earlier call of it.
  virtual void OnDue() = 0;
  /// It is over, and nothing follows.
  virtual void OnDown(const End& end) = 0;
};

/// One connection to a broker as bytes, and one timer: all that a client needs of the world. A
/// shared resource: what is under way keeps it alive; its owner parts from it by Close.
///
/// Thread: confined to that of its event loop.
class Link {
 public:
  virtual ~Link() = default;

  /// Resolves, connects, does the handshake. Once.
  virtual void Open(const Url& url, const TlsTexts& tls) = 0;
  /// One at a time; then OnRead, or OnDown.
  virtual void Read() = 0;
  /// What the last Read brought, until the next one begins.
  [[nodiscard]] virtual std::string_view input() const = 0;
  /// Bytes that came and were not read yet, as far as the system tells; 0 where there is no
  /// connection.
  [[nodiscard]] virtual std::size_t unread() const = 0;
  /// One at a time; then OnWritten. If it cannot be written, OnDown comes from the read that is
  /// under way, since what the broker said before may still be there, and else at once.
  virtual void Write(std::string bytes) = 0;
  /// Replaces an earlier time.
  virtual void WakeAt(SteadyTime time) = 0;
  /// No event follows. What is being written and then `last` still leave, if they can at once
  /// (kFarewellWait).
  virtual void Close(std::string last) = 0;
};

/// Makes links whose events go to this one, which outlives them or closes them.
using MakeLink = std::function<std::shared_ptr<Link>(LinkEvents&)>;

}  // namespace uplink::mqtt
