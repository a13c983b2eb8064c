#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"

namespace uplink::mqtt {

/// The state of a client.
enum class ClientState : std::uint8_t {
  kStopped,
  kConnecting,
  kSubscribing,
  kSubscribed,  // though filters may be refused
  kWaiting,     // until it connects again
  kIdTaken,     // the same, because another client uses its id
};

/// In the order of ClientState.
inline constexpr std::array<std::string_view, 6> kClientStateNames = {
    "stopped", "connecting", "subscribing", "subscribed", "waiting", "id_taken"};

[[nodiscard]] constexpr std::string_view Name(ClientState state) {
  return kClientStateNames[static_cast<std::size_t>(state)];
}

/// What operators see of a client. A value.
struct ClientStatus {
  ClientState state = ClientState::kStopped;
  /// Since when we are connected; empty while we are not.
  std::optional<SystemTime> connected_since;
  /// The broker resumed a kept session.
  bool session_present = false;
  /// PUBLISHes at QoS 1 that wait for their release.
  std::size_t unacked = 0;
  /// Filters that the broker refused, or serves at a lower QoS than asked for.
  std::size_t filters_refused = 0;
  std::size_t filters_lower = 0;
  /// When a kept session was last found to be gone.
  std::optional<SystemTime> session_lost_at;
  /// Why the last connection ended, or what the broker refused; at most kErrorBytesMax bytes. It
  /// stays until the next one, so that it can be read later.
  std::string last_error;
  std::optional<SystemTime> last_error_at;
};

/// A status that its client writes and any thread reads. Thread-safe.
class StatusBoard final {
 public:
  [[nodiscard]] ClientStatus Read() const {
    const std::lock_guard lock(mutex_);
    return status_;
  }
  void Change(const std::function<void(ClientStatus&)>& change) {
    const std::lock_guard lock(mutex_);
    change(status_);
  }

 private:
  mutable std::mutex mutex_;
  ClientStatus status_;
};

}  // namespace uplink::mqtt
