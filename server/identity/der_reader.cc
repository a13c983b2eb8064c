#include "server/identity/der_reader.h"

namespace uplink::identity {
namespace {

/// A tag with these bits continues in further bytes.
constexpr std::uint8_t kLongTag = 0x1F;
/// A first byte of the length from this value on says how many bytes of length follow.
constexpr std::uint8_t kLongLength = 0x80;
constexpr std::size_t kLengthBytesMax = 3;
/// The tags of a sequence and a set without the constructed bit.
constexpr std::uint8_t kPrimitiveSequence = 0x10;
constexpr std::uint8_t kPrimitiveSet = 0x11;

}  // namespace

std::optional<DerReader::Element> DerReader::Take() {
  if (rest_.size() < 2 || (rest_[0] & kLongTag) == kLongTag) return std::nullopt;
  const std::uint8_t tag = rest_[0];
  if (tag == kPrimitiveSequence || tag == kPrimitiveSet) return std::nullopt;
  std::size_t length = rest_[1];
  std::size_t head = 2;
  if (length >= kLongLength) {
    const std::size_t bytes = length - kLongLength;
    if (bytes == 0 || bytes > kLengthBytesMax || rest_.size() < head + bytes) return std::nullopt;
    length = 0;
    for (std::size_t i = 0; i < bytes; ++i) length = length << 8U | rest_[head + i];
    head += bytes;
    const std::size_t shortest = bytes == 1 ? kLongLength : std::size_t{1} << (8 * (bytes - 1));
    if (length < shortest) return std::nullopt;
  }
  if (length > rest_.size() - head) return std::nullopt;
  const Element element{.tag = tag, .content = rest_.subspan(head, length)};
  rest_ = rest_.subspan(head + length);
  return element;
}

std::optional<Bytes> DerReader::Take(DerTag tag) {
  if (!IsNext(tag)) return std::nullopt;
  const std::optional<Element> element = Take();
  if (!element) return std::nullopt;
  return element->content;
}

}  // namespace uplink::identity
