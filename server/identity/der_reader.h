#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace uplink::identity {

using Bytes = std::span<const std::uint8_t>;

/// The tags of DER in certificates.
enum class DerTag : std::uint8_t {
  kBoolean = 0x01,
  kInteger = 0x02,
  kBits = 0x03,
  kOctets = 0x04,
  kNull = 0x05,
  kOid = 0x06,
  kUtcTime = 0x17,
  kTime = 0x18,
  kSequence = 0x30,
  kSet = 0x31,
  /// Context tags: explicit ones enclose an element with its own tag, implicit ones replace its
  /// tag.
  kExplicit0 = 0xA0,
  kImplicit1 = 0x81,
  kImplicit2 = 0x82,
  kExplicit3 = 0xA3,
};

/// Takes elements of DER one after the other. It is stricter than OpenSSL, which reads BER too: an
/// element has a tag of one byte, and a definite length in its shortest form that ends within the
/// bytes; a sequence or set has the constructed bit, which OpenSSL does not require in a list.
/// So an element that is taken here is one element for OpenSSL too, with the same content.
///
/// Limits: lengths below 2^24, as a Certificate message of TLS has them. Nothing is allocated.
/// Thread: confined to one; a view of the bytes, which outlive it.
/// Source: X.690, 8.1.2, 8.1.3 and 10.1.
class DerReader final {
 public:
  explicit DerReader(Bytes bytes) : rest_(bytes) {}

  struct Element {
    std::uint8_t tag = 0;
    Bytes content;
  };

  /// The next element; nothing if there is none, or if it is not DER.
  [[nodiscard]] std::optional<Element> Take();
  /// The content of the next element; nothing if that has another tag.
  [[nodiscard]] std::optional<Bytes> Take(DerTag tag);
  [[nodiscard]] bool IsNext(DerTag tag) const {
    return !rest_.empty() && rest_.front() == static_cast<std::uint8_t>(tag);
  }
  [[nodiscard]] bool empty() const { return rest_.empty(); }
  [[nodiscard]] Bytes rest() const { return rest_; }

 private:
  Bytes rest_;
};

}  // namespace uplink::identity
