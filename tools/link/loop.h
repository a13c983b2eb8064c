#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/statusor.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

namespace uplink::link {

/// Bytes that are read from a connection at once: a TLS record.
inline constexpr std::size_t kReadBytes = 16 * 1024;

/// One thread's events, and the buffers that its connections share while they work.
///
/// Thread: confined to the thread that runs `io`.
struct Loop {
  boost::asio::io_context io{1};
  std::array<char, kReadBytes> in{};
  std::string out;
};

/// Where a server listens. A value.
struct Address {
  /// As it was given: what its certificate must say.
  std::string host;
  std::vector<boost::asio::ip::tcp::endpoint> endpoints;
  /// HOST:PORT, as HTTP's authority.
  std::string text;
};

/// Looks a HOST:PORT up; blocks for as long as the resolver takes.
///
/// Errors: kInvalidArgument for another form, kUnavailable if the host has no address.
[[nodiscard]] absl::StatusOr<Address> Resolve(const std::string& host_port);

}  // namespace uplink::link
