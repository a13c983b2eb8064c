#include "schema/cyberwave/payload.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "schema/base/utf8.h"
#include "schema/cyberwave/limits.h"
#include "schema/cyberwave/surrogates.h"
#include "schema/json/exact.h"
#include "schema/rules/describe.h"
#include "schema/rules/path.h"

namespace uplink::cyberwave {
namespace {

namespace js = boost::json;
using schema::Path;

constexpr std::size_t kLengthBytes = 4;
constexpr std::size_t kDoubleBytes = 8;
/// The double and the integer before a head's JSON.
constexpr std::size_t kStampBytes = 2 * kDoubleBytes;
constexpr unsigned kByteBits = 8;

PayloadReading Rejected(const schema::Violation& violation) {
  return {.value = {}, .rejection = violation.Describe()};
}

/// An integer of `bytes`, low byte first.
std::uint64_t LowFirst(std::string_view bytes) {
  std::uint64_t number = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) {
    number = number << kByteBits | static_cast<unsigned char>(bytes[i - 1]);
  }
  return number;
}

/// JSON has no NUL in its text, and the length of a head that fits a message has one as its last
/// byte.
bool IsFrame(std::string_view bytes) {
  return bytes.size() >= kLengthBytes && bytes[kLengthBytes - 1] == '\0';
}
static_assert(kMessageBytesMax < std::size_t{1} << (kByteBits * (kLengthBytes - 1)));

bool SaysJson(std::string_view head, const js::storage_ptr& memory) {
  const PayloadReading reading = ReadPayload(head, memory);
  if (reading.rejection) return false;
  const js::value* type = reading.value.get_object().if_contains("content_type");
  return type != nullptr && type->is_string() && type->get_string() == "application/json";
}

}  // namespace

PayloadReading ReadPayload(std::string_view text, const js::storage_ptr& memory) {
  if (!IsCleanUtf8(text)) return Rejected(schema::PayloadNotUtf8());
  json::ExactReading reading = json::ReadExact(text, {.depth_max = kDepthMax, .memory = memory});
  if (reading.error == js::error::exponent_overflow) return Rejected(schema::BeyondDouble());
  if (reading.error) {
    // The library does not tell a lone surrogate from other errors of syntax.
    if (HasLoneSurrogate(text)) return Rejected(schema::PayloadNotUtf8());
    return Rejected(schema::Malformed(reading.error.message()));
  }
  if (!reading.value.is_object()) {
    return Rejected(schema::TypeMismatch(Path(), json::KindOf(reading.value), "object"));
  }
  return {.value = std::move(reading.value), .rejection = {}};
}

PayloadReading ReadBridged(std::string_view bytes, const js::storage_ptr& memory) {
  if (!IsFrame(bytes)) return ReadPayload(bytes, memory);
  const std::uint64_t head_bytes = LowFirst(bytes.substr(0, kLengthBytes));
  bytes.remove_prefix(kLengthBytes);
  if (head_bytes < kStampBytes || head_bytes > bytes.size()) {
    return Rejected(schema::Malformed("the frame's head does not fit it"));
  }
  const std::string_view head = bytes.substr(0, head_bytes);
  if (!SaysJson(head.substr(kStampBytes), memory)) {
    return Rejected(schema::Malformed("the frame's content is not application/json"));
  }
  PayloadReading reading = ReadPayload(bytes.substr(head_bytes), memory);
  const auto seconds = std::bit_cast<double>(LowFirst(head.substr(0, kDoubleBytes)));
  if (std::isfinite(seconds)) reading.enclosed_seconds = seconds;
  return reading;
}

}  // namespace uplink::cyberwave
