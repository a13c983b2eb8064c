#include "server/http/source.h"

#include <algorithm>
#include <cstddef>

namespace uplink::http {
namespace {

constexpr std::array<std::uint8_t, 12> kIpv4InIpv6{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
constexpr std::size_t kIpv6PrefixBytes = 8;

}  // namespace

Source SourceOf(const std::array<std::uint8_t, 16>& address) {
  Source source = address;
  if (std::equal(kIpv4InIpv6.begin(), kIpv4InIpv6.end(), address.begin())) return source;
  std::fill(source.begin() + kIpv6PrefixBytes, source.end(), std::uint8_t{0});
  return source;
}

}  // namespace uplink::http
