#pragma once

#include <string_view>

#include <boost/json.hpp>
#include <google/protobuf/struct.pb.h>

namespace uplink::test {

/// The same object as a Struct of protobuf, whose numbers are doubles: integers beyond 2^53 lose
/// their last bits. Pure.
[[nodiscard]] google::protobuf::Struct ToStruct(const boost::json::object& object);

/// An object that is a text, as a reader of the contract's JSON gets it. A text that is none gives
/// an empty Struct.
[[nodiscard]] google::protobuf::Struct ParseStruct(std::string_view text);

}  // namespace uplink::test
