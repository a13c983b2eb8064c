#pragma once

#include <string>

#include "schema/model/record.h"

namespace uplink::schema {

/// One serialized UplinkMsg of generation 0.1, as a robot's agent would send it: standard stream
/// framing, unpacked. It judges nothing, so tests and the synthetic fleet can send what is wrong.
/// An absent number that has no hasX flag is written as NaN. A named event, which the format does
/// not know, is written without its kind, and judged as that.
///
/// Thread: pure; any thread.
[[nodiscard]] std::string Encode(const model::Body& body);

}  // namespace uplink::schema
