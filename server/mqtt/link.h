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

/// The steps before a connection is up, in this order.
enum class LinkPhase : std::uint8_t { kResolving, kConnecting, kHandshaking };

/// The owner of a link. Thread: all on the link's, never from within a method of the link.
class LinkEvents {
 public:
  virtual ~LinkEvents() = default;
  virtual void OnPhase(LinkPhase phase) = 0;
  virtual void OnUp() = 0;
  /// input() has bytes.
  virtual void OnRead() = 0;
  virtual void OnWritten() = 0;
  /// The time of WakeAt has come; may also be called for an earlier WakeAt.
  virtual void OnDue() = 0;
  /// The link has ended; no event follows.
  virtual void OnDown(const End& end) = 0;
};

/// One connection to a broker as bytes, and one timer: everything outside that a client needs. A
/// shared resource: pending operations keep it alive; its owner lets go of it by Close.
///
/// Thread: confined to that of its event loop.
class Link {
 public:
  virtual ~Link() = default;

  /// Resolves, connects, does the handshake. Once.
  virtual void Open(const Url& url, const TlsTexts& tls) = 0;
  /// One at a time; OnRead or OnDown follows.
  virtual void Read() = 0;
  /// The bytes of the last Read, until the next one begins.
  [[nodiscard]] virtual std::string_view input() const = 0;
  /// Bytes that the kernel holds unread; 0 without a connection.
  [[nodiscard]] virtual std::size_t unread() const = 0;
  /// One at a time; OnWritten follows. If it fails, OnDown comes from the pending read, since the
  /// broker's last bytes may still be there, or at once without one.
  virtual void Write(std::string bytes) = 0;
  /// Replaces an earlier time.
  virtual void WakeAt(SteadyTime time) = 0;
  /// No event follows. The current write and then `last` are still sent, if that is possible at
  /// once (kFarewellWait).
  virtual void Close(std::string last) = 0;
};

/// Makes links whose events go to this object, which outlives them or closes them.
using MakeLink = std::function<std::shared_ptr<Link>(LinkEvents&)>;

}  // namespace uplink::mqtt
