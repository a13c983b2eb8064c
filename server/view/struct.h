#pragma once

#include <string_view>

#include <boost/json.hpp>
#include <google/protobuf/struct.pb.h>

namespace uplink::view {

/// The same object as a Struct of protobuf, whose numbers are doubles: integers beyond 2^53 lose
/// their last bits. Pure.
[[nodiscard]] google::protobuf::Struct ToStruct(const boost::json::object& object);

/// The object that a store keeps as text. A text that is none gives an empty Struct: the store's
/// own texts are objects.
[[nodiscard]] google::protobuf::Struct ParseStruct(std::string_view text);

}  // namespace uplink::view
