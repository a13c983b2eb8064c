#pragma once

#include <string>
#include <string_view>

#include <google/protobuf/message.h>

namespace uplink::rpc {

/// A request of FleetView as the query of the HTTP path that answers the same: each field that is
/// set under its JSON name, so that both ways are read and judged by one reader. A field without a
/// value of its own (empty, zero, false) is not set.
///
/// Thread: pure; any thread.
[[nodiscard]] std::string QueryOf(const google::protobuf::Message& request);

/// Adds `name=value`, encoded, to a query.
void AppendParameter(std::string_view name, std::string_view value, std::string& query);

}  // namespace uplink::rpc
