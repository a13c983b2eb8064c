#pragma once

#include <string>
#include <string_view>

namespace uplink::schema {

/// A URI without the name and the password that it may hold: before the host, and as parameters of
/// the query (`user`, `username`, `pass`, `passwd`, `password`, `pwd`), whose values go. Pure.
[[nodiscard]] std::string WithoutCredentials(std::string_view uri);

}  // namespace uplink::schema
