#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

// What a hostile client says on HTTP/2: more than a peer may ask for. Streams are numbered from
// `first` (1 on a new connection) on, and the peer's SETTINGS are not heeded.
namespace uplink::testing::attack {

/// The number of a client's stream after so many.
[[nodiscard]] constexpr std::uint32_t After(std::uint32_t first, std::size_t streams) {
  return first + 2 * static_cast<std::uint32_t>(streams);
}

/// Calls of Relay that are opened, and nothing more.
[[nodiscard]] std::string Opened(std::uint32_t first, std::size_t streams);
/// Calls of Relay that are taken back at once (CVE-2023-44487, "rapid reset").
[[nodiscard]] std::string RapidResets(std::uint32_t first, std::size_t streams);
/// A call whose message announces so many bytes, and only `sent` come.
[[nodiscard]] std::string Announcement(std::uint32_t stream, std::uint32_t bytes, std::size_t sent);
/// A call with a header of so many bytes, in a frame and its CONTINUATIONs.
[[nodiscard]] std::string LongHeader(std::uint32_t stream, std::size_t bytes);
/// A call whose header of nearly 4 KB is kept in HPACK's table.
[[nodiscard]] std::string HeaderBombFuse(std::uint32_t stream);
/// A call that names the kept header 16,000 times: a byte on the wire is 4 KB of headers.
[[nodiscard]] std::string HeaderBomb(std::uint32_t stream);
/// The same in the trailers of a call that is open.
[[nodiscard]] std::string HeaderBombInTrailers(std::uint32_t stream);
/// A call whose headers do not end.
[[nodiscard]] std::string HeadersWithoutEnd(std::uint32_t stream);
/// One more CONTINUATION of them, with a header of 16 KB.
[[nodiscard]] std::string EndlessContinuation(std::uint32_t stream);

}  // namespace uplink::testing::attack
