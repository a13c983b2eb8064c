#pragma once

#include <string_view>

#include <boost/json.hpp>
#include <google/protobuf/message.h>

namespace uplink::synthetic {

/// A sample as `Robot.uncrew` shows it, by the rules of docs/integrate/uncrew.md: by the contract's
/// names with capitals in place of underscores; what is not known is absent, enumerants are their
/// names in small letters, and `key`, by which it is found, is left out. Pure; any thread.
[[nodiscard]] boost::json::object ShownOf(const google::protobuf::Message& sample,
                                          std::string_view key = {});

}  // namespace uplink::synthetic
