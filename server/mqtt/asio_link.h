#pragma once

#include <memory>

#include "server/mqtt/link.h"

namespace boost::asio {
class io_context;
}  // namespace boost::asio

namespace uplink::mqtt {

/// A link over TCP, or TLS on it, on the thread of `io`. A name is resolved on Asio's own thread,
/// one at a time for all links; each address that it has is tried in turn.
[[nodiscard]] std::shared_ptr<Link> MakeAsioLink(boost::asio::io_context& io, LinkEvents& events);

}  // namespace uplink::mqtt
