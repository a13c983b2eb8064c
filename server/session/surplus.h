#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "metrics/kinds.h"
#include "server/session/frame_view.h"

namespace uplink::session {

/// The latest telemetry of each kind over its robot's rate, undecoded. It is decoded once the rate
/// allows it, so that a burst ends with its last message. Allocates with the first message and
/// frees after the last.
///
/// Bound:  one payload for each of metrics::kTelemetryKinds, of limits.message_bytes_max.
/// Thread: confined to the stream's thread.
class Surplus final {
 public:
  /// A place in metrics::kTelemetryKinds; empty for other kinds.
  [[nodiscard]] static std::optional<std::size_t> PlaceOf(std::size_t kind);

  [[nodiscard]] bool empty() const { return slots_ == nullptr; }
  /// Holds the message in place of an older one of its kind; true if there was one. The view must
  /// stay valid until Keep.
  [[nodiscard]] bool Put(std::size_t place, const UplinkView& uplink);
  /// A newer one of its kind came: true if one was held.
  [[nodiscard]] bool Drop(std::size_t place);
  /// Takes the message out; its payload is valid until the next call. Empty if none is held.
  [[nodiscard]] std::optional<UplinkView> Take(std::size_t place);
  /// Copies held messages: the frame's bytes are about to go.
  void Keep();
  /// Frees the memory, if nothing is held.
  void Shrink();

 private:
  struct Slot {
    std::optional<UplinkView> uplink;
    std::string bytes;
    bool is_kept = false;
  };
  using Slots = std::array<Slot, metrics::kTelemetryKinds.size()>;

  std::unique_ptr<Slots> slots_;
};

}  // namespace uplink::session
