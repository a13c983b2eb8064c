#pragma once

#include <cstdint>

namespace uplink::view {

/// How answers are written: the proto3 JSON mapping of the contract's messages, or the messages as
/// protobuf has them on the wire. Both say the same.
enum class Form : std::uint8_t { kJson, kWire };

}  // namespace uplink::view
