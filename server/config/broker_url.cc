#include "server/config/broker_url.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>

namespace uplink::config {
namespace {

constexpr std::string_view kTlsScheme = "mqtts://";
constexpr std::string_view kPlainScheme = "mqtt://";

absl::Status Invalid(std::string_view text) {
  return absl::InvalidArgumentError(fmt::format("mqtt.url {}", text));
}

bool IsIpv6(const std::string& text) {
  in6_addr address{};
  return inet_pton(AF_INET6, text.c_str(), &address) == 1;
}

bool IsNameCharacter(char each) {
  return (each >= 'a' && each <= 'z') || (each >= 'A' && each <= 'Z') ||
         (each >= '0' && each <= '9') || each == '-' || each == '.' || each == '_';
}

std::optional<std::uint16_t> PortOf(std::string_view text) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc() || end != text.data() + text.size() || port == 0) return std::nullopt;
  return port;
}

absl::Status CheckHost(std::string_view host) {
  if (host.empty()) return Invalid("names no host");
  if (host.size() > kBrokerHostBytesMax) {
    return Invalid(
        fmt::format("has a host of {} bytes, at most {}", host.size(), kBrokerHostBytesMax));
  }
  if (!std::ranges::all_of(host, IsNameCharacter)) {
    return Invalid("has a host with characters that no name has");
  }
  return absl::OkStatus();
}

}  // namespace

std::string BrokerUrl::Text() const {
  const bool ipv6 = host.find(':') != std::string::npos;
  return fmt::format("{}{}{}{}:{}", tls ? kTlsScheme : kPlainScheme, ipv6 ? "[" : "", host,
                     ipv6 ? "]" : "", port);
}

absl::StatusOr<BrokerUrl> ParseBrokerUrl(std::string_view text) {
  BrokerUrl url{.tls = text.starts_with(kTlsScheme)};
  if (!url.tls && !text.starts_with(kPlainScheme)) {
    return Invalid("begins with neither mqtts:// nor mqtt://");
  }
  text.remove_prefix(url.tls ? kTlsScheme.size() : kPlainScheme.size());
  url.port = url.tls ? kMqttsPort : kMqttPort;
  if (text.ends_with('/')) text.remove_suffix(1);
  if (text.find('@') != std::string_view::npos) {
    return Invalid("holds a user: set mqtt.username and mqtt.password_file instead");
  }
  if (text.find_first_of("/?#") != std::string_view::npos) {
    return Invalid("goes on after host and port: MQTT has no path");
  }
  std::string_view port;
  bool has_port = false;
  if (text.starts_with('[')) {
    const std::size_t end = text.find(']');
    if (end == std::string_view::npos) return Invalid("has a [ without its ]");
    url.host = text.substr(1, end - 1);
    if (!IsIpv6(url.host)) return Invalid("has no IPv6 address between its brackets");
    port = text.substr(end + 1);
    has_port = !port.empty();
    if (has_port && !port.starts_with(':'))
      return Invalid("has something else than a port behind ]");
    if (has_port) port.remove_prefix(1);
  } else {
    const std::size_t colon = text.find(':');
    if (colon != text.rfind(':')) return Invalid("has an IPv6 address without [ and ]");
    has_port = colon != std::string_view::npos;
    url.host = text.substr(0, colon);
    if (has_port) port = text.substr(colon + 1);
    if (absl::Status good = CheckHost(url.host); !good.ok()) return good;
  }
  if (!has_port) return url;
  const auto number = PortOf(port);
  if (!number) return Invalid("has no port from 1 to 65535 behind its colon");
  url.port = *number;
  return url;
}

}  // namespace uplink::config
