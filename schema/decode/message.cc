#include "schema/decode/message.h"

#include <cstdint>

#include "schema/limits.h"

namespace uplink::schema {
namespace {

std::uint32_t LittleEndian32(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < sizeof(value); ++i) {
    value |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  }
  return value;
}

}  // namespace

std::string_view FramingError(std::span<const std::byte> bytes) {
  if (bytes.empty()) return "it is empty";
  if (bytes.size() % kWordBytes != 0) return "its size is no multiple of 8 bytes";
  const std::size_t segments = std::size_t{LittleEndian32(bytes, 0)} + 1;
  if (segments > kSegmentsMax) return "its segment table has too many entries";
  const std::size_t words = bytes.size() / kWordBytes;
  std::size_t described = segments / 2 + 1;
  if (described > words) return "it ends within its segment table";
  if (LittleEndian32(bytes, 4) == 0) return "its first segment is empty";
  for (std::size_t i = 0; i < segments; ++i) {
    described += LittleEndian32(bytes, 4 * (i + 1));
  }
  if (described > words) return "it ends before its last segment does";
  if (described < words) return "bytes follow its last segment";
  return {};
}

capnp::ReaderOptions OptionsFor(std::size_t words) {
  capnp::ReaderOptions options;
  options.traversalLimitInWords = words * kTraversalFactor;
  options.nestingLimit = kNestingMax;
  return options;
}

}  // namespace uplink::schema
