#pragma once

#include <memory>

#include "server/mqtt/link.h"

namespace boost::asio {
class io_context;
}  // namespace boost::asio

namespace uplink::mqtt {

/// A link over TCP, or TLS, on the thread of `io`. Asio's own thread resolves names, one at a time
/// for all links; the link tries each address in turn.
[[nodiscard]] std::shared_ptr<Link> MakeAsioLink(boost::asio::io_context& io, LinkEvents& events);

}  // namespace uplink::mqtt
