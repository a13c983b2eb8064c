#include "server/config/address.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <system_error>

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>

#include "schema/base/utf8.h"

namespace uplink::config {
namespace {

constexpr std::string_view kUnixScheme = "unix:";

std::optional<std::uint16_t> ParsePort(std::string_view text) {
  std::uint16_t port = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, port);
  if (text.empty() || error != std::errc() || stop != end) {
    return std::nullopt;
  }
  return port;
}

using HostBytes = std::array<std::uint8_t, sizeof(in6_addr)>;

/// An address of IPv4 as one of IPv6 (::ffff:a.b.c.d), but 0.0.0.0 stays apart from `::`.
HostBytes BytesOf(const std::string& host) {
  HostBytes bytes{};
  if (::inet_pton(AF_INET6, host.c_str(), bytes.data()) == 1) return bytes;
  bytes[10] = bytes[11] = 0xFF;
  static_cast<void>(::inet_pton(AF_INET, host.c_str(), bytes.data() + 12));
  return bytes;
}

/// Whether a listener on `all` hears what is sent to `host`.
bool Covers(const HostBytes& all, const HostBytes& host) {
  if (all == BytesOf("::")) return true;
  const auto v4 = BytesOf("0.0.0.0");
  return all == v4 && std::equal(v4.begin(), v4.begin() + 12, host.begin());
}

/// A socket's path; nothing if it names no file.
std::optional<ListenAddress> ParsePath(std::string_view path) {
  const bool names_file = path.size() > 1 && path.front() == '/' && path.back() != '/';
  const bool shown = CountControls(path) == 0U && path.find_first_of("\t\r\n") == path.npos;
  if (!names_file || path.size() > kSocketPathBytesMax || !shown) return std::nullopt;
  return ListenAddress{.host = {}, .port = 0, .path = std::string(path)};
}

}  // namespace

std::optional<ListenAddress> ParseListenAddress(std::string_view text) {
  if (text.starts_with(kUnixScheme)) return ParsePath(text.substr(kUnixScheme.size()));
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) {
    return std::nullopt;
  }
  const std::optional<std::uint16_t> port = ParsePort(text.substr(colon + 1));
  std::string_view host = text.substr(0, colon);
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (bracketed) {
    host = host.substr(1, host.size() - 2);
  }
  in6_addr parsed{};
  const std::string name(host);
  const bool whole = name.find('\0') == std::string::npos;  // inet_pton would stop there
  if (!port || !whole || ::inet_pton(bracketed ? AF_INET6 : AF_INET, name.c_str(), &parsed) != 1) {
    return std::nullopt;
  }
  return ListenAddress{name, *port};
}

bool IsSet(const ListenAddress& address) { return !address.host.empty() || IsUnix(address); }

bool IsUnix(const ListenAddress& address) { return !address.path.empty(); }

std::string ToText(const ListenAddress& address) {
  if (!IsSet(address)) return {};
  if (IsUnix(address)) return fmt::format("{}{}", kUnixScheme, address.path);
  const bool v6 = address.host.find(':') != std::string::npos;
  return v6 ? fmt::format("[{}]:{}", address.host, address.port)
            : fmt::format("{}:{}", address.host, address.port);
}

bool Collide(const ListenAddress& a, const ListenAddress& b) {
  if (IsUnix(a) || IsUnix(b)) return a.path == b.path;
  if (!IsSet(a) || !IsSet(b) || a.port == 0 || a.port != b.port) return false;
  const HostBytes bytes_a = BytesOf(a.host);
  const HostBytes bytes_b = BytesOf(b.host);
  return bytes_a == bytes_b || Covers(bytes_a, bytes_b) || Covers(bytes_b, bytes_a);
}

bool IsLoopback(const ListenAddress& address) {
  return IsUnix(address) || IsLoopbackHost(address.host);
}

bool IsLoopbackHost(const std::string& host) {
  in6_addr v6{};
  in_addr v4{};
  if (::inet_pton(AF_INET6, host.c_str(), &v6) == 1) return IN6_IS_ADDR_LOOPBACK(&v6);
  if (::inet_pton(AF_INET, host.c_str(), &v4) == 1) return host.starts_with("127.");
  return host == "localhost";
}

}  // namespace uplink::config
