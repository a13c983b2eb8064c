#pragma once

#include <string>

#include <google/protobuf/message.h>

namespace uplink::rpc {

/// A request of FleetView as the query of the HTTP path that answers the same: each field that is
/// set under its JSON name, so that both ways are read and judged by one reader. A field without a
/// value of its own (empty, zero, false) is not set.
///
/// Thread: pure; any thread.
[[nodiscard]] std::string QueryOf(const google::protobuf::Message& request);

}  // namespace uplink::rpc
