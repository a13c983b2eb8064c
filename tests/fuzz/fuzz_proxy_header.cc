#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <netinet/in.h>

#include "schema/base/check.h"
#include "server/front/door/origin.h"
#include "server/front/door/proxy_header.h"

namespace {

using uplink::front::ProxyHeader;

struct Read {
  ProxyHeader header;
  std::size_t taken = 0;
};

/// Gives it the bytes, at most so many at once, as long as it wants some.
Read ReadIn(std::string_view bytes, std::size_t piece) {
  Read read;
  while (read.header.wanted() > 0 && read.taken < bytes.size()) {
    const std::size_t wanted = read.header.wanted();
    UPLINK_CHECK(read.taken + wanted <= ProxyHeader::kFixedBytes + ProxyHeader::kRestBytesMax,
                 "no header is longer");
    const std::string_view next = bytes.substr(read.taken, std::min(piece, wanted));
    read.header.Take(next);
    read.taken += next.size();
  }
  return read;
}

void CheckSource(const ProxyHeader& header) {
  const bool relayed = header.result() == ProxyHeader::Result::kRelayed;
  const auto family = header.source().ss_family;
  UPLINK_CHECK(relayed ? family == AF_INET || family == AF_INET6 : family == AF_UNSPEC,
               "an address, where one was told");
  const uplink::front::Origin origin = uplink::front::OriginOf(header.source());
  UPLINK_CHECK(relayed == (origin.source != uplink::front::SourceAddress()) &&
                   relayed == (origin.text != "unknown"),
               "a known source, where one was told");
}

}  // namespace

/// However the bytes are cut, the header that they begin with is the same and ends at the same
/// byte.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const Read whole = ReadIn(bytes, size + 1);
  CheckSource(whole.header);
  UPLINK_CHECK(
      (whole.header.wanted() == 0) == (whole.header.result() != ProxyHeader::Result::kMore),
      "it wants bytes until it is over");
  for (const std::size_t piece : {std::size_t{1}, std::size_t{5}, std::size_t{16}}) {
    const Read pieces = ReadIn(bytes, piece);
    UPLINK_CHECK(pieces.header.result() == whole.header.result(), "the same result");
    UPLINK_CHECK(uplink::front::OriginOf(pieces.header.source()).text ==
                     uplink::front::OriginOf(whole.header.source()).text,
                 "the same source");
    // What is no header may be known by its first wrong byte.
    UPLINK_CHECK(
        pieces.taken == whole.taken || whole.header.result() == ProxyHeader::Result::kInvalid,
        "it ends at the same byte");
  }
  return 0;
}
