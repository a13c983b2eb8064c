#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "server/config/broker_url.h"
#include "server/mqtt/packets.h"
#include "server/mqtt/reconnect.h"

namespace uplink::mqtt {

/// Where a broker is; the configuration judges it, and takes it apart.
using Url = config::BrokerUrl;

/// How long a client waits for what; tests shorten it. limits.h says what each is.
struct Waits {
  milliseconds resolve;
  milliseconds connect;
  milliseconds tls;
  milliseconds answer;
  milliseconds ping;
  milliseconds write;
  milliseconds refused;

  /// Those of limits.h.
  Waits();
};

/// A smaller one could only be none, by which a broker never takes us for gone.
inline constexpr std::chrono::seconds kKeepaliveMin{1};

/// How one connection to a broker is made. A value.
struct ClientSettings {
  Url url;
  Version version = Version::k5;
  std::string client_id;
  /// Empty: none. A password needs one.
  std::string username;
  /// Read at each connection; empty: no password. A line end at its end is not part of it.
  std::string password_file;
  /// Authorities that may vouch for the broker, PEM; empty: those of the system.
  std::string ca_file;
  /// A client certificate and its key, PEM; both or none.
  std::string certificate_file;
  std::string key_file;

  /// The broker keeps a session of ours while we are away.
  bool kept_session = false;
  /// The broker may have one from before our start: one that is missing then is a lost one.
  bool expect_session = false;
  /// How long the broker is to keep it (MQTT 5; by 3.1.1 that is the broker's own affair).
  std::chrono::seconds session_expiry = std::chrono::hours(24);
  std::chrono::seconds keepalive{60};
  /// Messages at QoS 1 that the core has not released. By MQTT 5 the broker is told (Receive
  /// Maximum); past it we read no further.
  std::size_t unacked_max = 1024;
  /// Bytes of the largest payload that the core wants; larger ones are read past.
  std::size_t payload_bytes_max = std::size_t{64} * 1024;
  /// Bytes of the largest packet that the broker is to send us, by MQTT 5; it drops what is larger
  /// and tells nobody. 0: not said.
  std::uint32_t announced_packet_bytes_max = 0;

  ReconnectLimits reconnect;
  Waits waits;
};

/// Whether a client can work by these.
///
/// Errors: kInvalidArgument with a sentence that begins with the key of the configuration
///         (`mqtt.client_id`) and names the limit.
[[nodiscard]] absl::Status CheckSettings(const ClientSettings& settings);

/// Whether these can be asked for: kFiltersMax, kFilterBytesMax, UTF-8, wildcards where MQTT has
/// them.
///
/// Errors: kInvalidArgument names the filter.
[[nodiscard]] absl::Status CheckFilters(const std::vector<Filter>& filters);

}  // namespace uplink::mqtt
