#pragma once

#include <cstddef>
#include <string>

// First messages of TLS 1.3 clients, with parts that cost the server something to go through.
namespace uplink::bench {

/// What fills a ClientHello up to a size.
enum class Filler { kKeyShares, kGroupsAndKeyShares, kSessions, kSuites, kAlgorithms, kExtensions };

/// A ClientHello in one record, of about so many bytes. It ends with the share of a client that has
/// thrown its key away: the server answers it as any other.
[[nodiscard]] std::string HelloWith(Filler filler, std::size_t bytes);

}  // namespace uplink::bench
