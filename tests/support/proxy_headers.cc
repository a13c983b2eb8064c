#include "tests/support/proxy_headers.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include "schema/base/check.h"

namespace uplink::testing {
namespace {

template <typename Address>
std::string BytesOf(int family, const std::string& text) {
  std::string bytes(sizeof(Address), '\0');
  UPLINK_CHECK(::inet_pton(family, text.c_str(), bytes.data()) == 1, "a literal address");
  return bytes;
}

std::string TwoBytes(std::size_t number) {
  return {static_cast<char>(number >> 8U), static_cast<char>(number & 0xFFU)};
}

bool IsIpv6(const std::string& address) { return address.find(':') != std::string::npos; }

}  // namespace

std::string ProxyHeaderBytes(std::uint8_t command, std::uint8_t family, std::string_view rest) {
  std::string header(kProxySignature);
  header += static_cast<char>(command);
  header += static_cast<char>(family);
  header += TwoBytes(rest.size());
  return header.append(rest);
}

std::string ProxyAddresses(const std::string& source, std::uint16_t port) {
  const std::string addresses =
      IsIpv6(source) ? BytesOf<in6_addr>(AF_INET6, source) + BytesOf<in6_addr>(AF_INET6, "::1")
                     : BytesOf<in_addr>(AF_INET, source) + BytesOf<in_addr>(AF_INET, "127.0.0.1");
  return addresses + TwoBytes(port) + TwoBytes(7443);
}

std::string ProxyHeaderFor(const std::string& source, std::uint16_t port, std::string_view more) {
  return ProxyHeaderBytes(kProxyRelayed, IsIpv6(source) ? kProxyTcp6 : kProxyTcp4,
                          ProxyAddresses(source, port).append(more));
}

std::string LocalProxyHeader() { return ProxyHeaderBytes(kProxyLocal, kProxyUnspec, {}); }

std::string ProxyTlv(std::uint8_t type, std::string_view value) {
  return std::string(1, static_cast<char>(type)).append(TwoBytes(value.size())).append(value);
}

}  // namespace uplink::testing
