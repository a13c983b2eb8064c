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

/// The address of a broker; the configuration checks and parses it.
using Url = config::BrokerUrl;

/// Deadlines of a client; tests shorten them. limits.h explains each.
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

/// The next smaller one is 0, with which a broker never considers us gone.
inline constexpr std::chrono::seconds kKeepaliveMin{1};

/// How one connection to a broker is made. A value.
struct ClientSettings {
  Url url;
  Version version = Version::k5;
  std::string client_id;
  /// Empty: none. A password requires one.
  std::string username;
  /// Read at each connection; empty: no password. A line end at its end is not part of it.
  std::string password_file;
  /// Authorities for the broker's certificate, PEM; empty: those of the system.
  std::string ca_file;
  /// A client certificate and its key, PEM; both or none.
  std::string certificate_file;
  std::string key_file;

  /// The broker keeps a session of ours while we are away.
  bool kept_session = false;
  /// The broker may have a session from before our start: if it is missing then, it was lost.
  bool expect_session = false;
  /// How long the broker must keep it (MQTT 5; in 3.1.1 the broker decides).
  std::chrono::seconds session_expiry = std::chrono::hours(24);
  std::chrono::seconds keepalive{60};
  /// Messages at QoS 1 that the core may leave unreleased; past them we stop reading. MQTT 5
  /// announces it to the broker (Receive Maximum).
  std::size_t unacked_max = 1024;
  /// Bytes of the largest payload that the core wants; larger ones are skipped.
  std::size_t payload_bytes_max = std::size_t{64} * 1024;
  /// Bytes of the largest packet that the broker may send us, in MQTT 5; it silently drops larger
  /// ones. 0: not announced.
  std::uint32_t announced_packet_bytes_max = 0;

  ReconnectLimits reconnect;
  Waits waits;
};

/// Checks whether a client can use these settings.
///
/// Errors: kInvalidArgument, whose text begins with the key of the configuration (`mqtt.client_id`)
///         and names the limit.
[[nodiscard]] absl::Status CheckSettings(const ClientSettings& settings);

/// Checks whether these can be asked for: kFiltersMax, kFilterBytesMax, UTF-8, and wildcards where
/// MQTT allows them.
///
/// Errors: kInvalidArgument names the filter.
[[nodiscard]] absl::Status CheckFilters(const std::vector<Filter>& filters);

}  // namespace uplink::mqtt
