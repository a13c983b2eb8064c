#include "server/config/networks.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>
#include <system_error>

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>

#include "schema/base/utf8.h"

namespace uplink::config {
namespace {

using Bytes = std::array<std::uint8_t, 16>;

constexpr std::array<std::uint8_t, 12> kIpv4InIpv6{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
constexpr unsigned kByteBits = 8;
constexpr unsigned kAddressBits = 128;
constexpr unsigned kIpv4InIpv6Bits = kIpv4InIpv6.size() * kByteBits;
/// Longest part of a wrong network that an error repeats.
constexpr std::size_t kShownBytesMax = 100;

bool HoldsIpv4(const Bytes& bytes) {
  return std::equal(kIpv4InIpv6.begin(), kIpv4InIpv6.end(), bytes.begin());
}

Bytes BytesOf(const in_addr& address) {
  Bytes bytes;
  std::copy(kIpv4InIpv6.begin(), kIpv4InIpv6.end(), bytes.begin());
  std::memcpy(&bytes[kIpv4InIpv6.size()], &address, sizeof(address));
  return bytes;
}

Bytes BytesOf(const in6_addr& address) {
  Bytes bytes;
  static_assert(sizeof(address) == sizeof(bytes));
  std::memcpy(bytes.data(), &address, sizeof(address));
  return bytes;
}

std::optional<Bytes> BytesOf(const sockaddr_storage& address) {
  if (address.ss_family == AF_INET) {
    sockaddr_in ipv4{};
    std::memcpy(&ipv4, &address, sizeof(ipv4));
    return BytesOf(ipv4.sin_addr);
  }
  if (address.ss_family == AF_INET6) {
    sockaddr_in6 ipv6{};
    std::memcpy(&ipv6, &address, sizeof(ipv6));
    return BytesOf(ipv6.sin6_addr);
  }
  return std::nullopt;
}

/// A literal address, and how many bits of the bytes come before those that it writes.
struct Literal {
  Bytes bytes{};
  unsigned before_bits = 0;
};

std::optional<Literal> ParseLiteral(const std::string& text) {
  // inet_pton would stop at a NUL.
  if (text.find('\0') != std::string::npos) return std::nullopt;
  in_addr ipv4{};
  if (::inet_pton(AF_INET, text.c_str(), &ipv4) == 1)
    return Literal{BytesOf(ipv4), kIpv4InIpv6Bits};
  in6_addr ipv6{};
  if (::inet_pton(AF_INET6, text.c_str(), &ipv6) == 1) return Literal{BytesOf(ipv6), 0};
  return std::nullopt;
}

/// What stands behind the slash; nothing if it is no number up to `max`.
std::optional<unsigned> ParsePrefix(std::string_view text, unsigned max) {
  unsigned bits = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, bits);
  if (text.empty() || error != std::errc() || stop != end || bits > max) return std::nullopt;
  return bits;
}

/// The bytes with zeros behind so many bits.
Bytes Masked(Bytes bytes, unsigned prefix_bits) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const unsigned before = static_cast<unsigned>(i) * kByteBits;
    const unsigned kept = std::clamp(prefix_bits, before, before + kByteBits) - before;
    bytes[i] = static_cast<std::uint8_t>(bytes[i] & (0xFF00U >> kept));
  }
  return bytes;
}

std::string Shown(std::string_view text) {
  return fmt::format("\"{}\"", PrintableUtf8(text, kShownBytesMax));
}

}  // namespace

absl::StatusOr<Network> Network::Parse(std::string_view text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const std::optional<Literal> literal = ParseLiteral(std::string(text.substr(0, slash)));
  std::optional<unsigned> prefix;
  if (literal) {
    const unsigned max = kAddressBits - literal->before_bits;
    prefix = slash == text.size() ? max : ParsePrefix(text.substr(slash + 1), max);
  }
  if (!prefix) {
    return absl::InvalidArgumentError(fmt::format(
        "{} is no network; write a literal address, or one with the length of its prefix, such as "
        "\"10.0.0.0/8\", \"192.0.2.7\" or \"2001:db8::/32\"",
        Shown(text)));
  }
  const unsigned bits = literal->before_bits + *prefix;
  const Bytes masked = Masked(literal->bytes, bits);
  if (masked != literal->bytes) {
    return absl::InvalidArgumentError(fmt::format(
        "{} has bits set beyond its prefix; the network is \"{}\", and the address alone \"{}\"",
        Shown(text), Network(masked, bits).ToText(),
        Network(literal->bytes, kAddressBits).ToText()));
  }
  return Network(masked, bits);
}

bool Network::is_ipv4() const { return prefix_bits_ >= kIpv4InIpv6Bits && HoldsIpv4(bytes_); }

bool Network::Contains(const sockaddr_storage& address) const {
  const std::optional<Bytes> bytes = BytesOf(address);
  return bytes && HoldsIpv4(*bytes) == is_ipv4() && Masked(*bytes, prefix_bits_) == bytes_;
}

std::string Network::ToText() const {
  std::array<char, INET6_ADDRSTRLEN> text{};
  unsigned bits = prefix_bits_;
  if (is_ipv4()) {
    ::inet_ntop(AF_INET, &bytes_[kIpv4InIpv6.size()], text.data(), text.size());
    bits -= kIpv4InIpv6Bits;
  } else {
    ::inet_ntop(AF_INET6, bytes_.data(), text.data(), text.size());
  }
  return prefix_bits_ == kAddressBits ? text.data() : fmt::format("{}/{}", text.data(), bits);
}

absl::StatusOr<std::vector<Network>> ParseNetworks(const std::vector<std::string>& texts) {
  std::vector<Network> networks;
  networks.reserve(texts.size());
  for (const std::string& text : texts) {
    absl::StatusOr<Network> network = Network::Parse(text);
    if (!network.ok()) return network.status();
    networks.push_back(*network);
  }
  return networks;
}

std::vector<Network> LoopbackNetworks() { return *ParseNetworks({"127.0.0.0/8", "::1"}); }

bool Contains(const std::vector<Network>& networks, const sockaddr_storage& address) {
  return std::ranges::any_of(networks, [&](const Network& each) { return each.Contains(address); });
}

}  // namespace uplink::config
