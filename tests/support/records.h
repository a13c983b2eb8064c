#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "schema/model/record.h"

namespace uplink::test {

/// The bytes of an encoded payload as schema::Judge takes them; a view.
[[nodiscard]] inline std::span<const std::byte> AsPayload(std::string_view bytes) {
  return std::as_bytes(std::span(bytes.data(), bytes.size()));
}

/// A record as an agent's message becomes one: `body` encoded, and judged by the default limits.
/// Aborts with the reason if it is rejected, since a test's own message must be good.
[[nodiscard]] model::Record RecordOf(const model::Body& body);

}  // namespace uplink::test
