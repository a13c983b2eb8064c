#include "server/identity/public_key_gate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <string_view>

namespace uplink::identity {
namespace {

// Object identifiers, as the content of their element.
constexpr std::string_view kEcKey("\x2A\x86\x48\xCE\x3D\x02\x01", 7);
constexpr std::string_view kRsa("\x2A\x86\x48\x86\xF7\x0D\x01\x01\x01", 9);
constexpr std::string_view kRsaPss("\x2A\x86\x48\x86\xF7\x0D\x01\x01\x0A", 9);
constexpr std::string_view kEd25519("\x2B\x65\x70", 3);
constexpr std::string_view kEd448("\x2B\x65\x71", 3);

/// A curve, and how many bytes an element of its field has.
struct Curve {
  std::string_view oid;
  std::size_t field_bytes = 0;
};
constexpr std::array kCurves = {
    Curve{.oid = std::string_view("\x2A\x86\x48\xCE\x3D\x03\x01\x07", 8), .field_bytes = 32},
    Curve{.oid = std::string_view("\x2B\x81\x04\x00\x22", 5), .field_bytes = 48},
    Curve{.oid = std::string_view("\x2B\x81\x04\x00\x23", 5), .field_bytes = 66}};

constexpr std::size_t kEd25519Bytes = 32;
constexpr std::size_t kEd448Bytes = 57;
/// Bytes of RSA-PSS's parameters. All four, with the longest digest, have 54.
constexpr std::size_t kPssParametersBytesMax = 128;

constexpr std::uint8_t kCompressedEven = 2;
constexpr std::uint8_t kCompressedOdd = 3;
constexpr std::uint8_t kUncompressed = 4;

bool Is(Bytes bytes, std::string_view text) {
  return std::ranges::equal(bytes, text, {}, {},
                            [](char c) { return static_cast<std::uint8_t>(c); });
}

KeyFlaw FlawOfPoint(DerReader parameters, Bytes point) {
  const auto oid = parameters.Take(DerTag::kOid);
  if (!oid || !parameters.empty()) return KeyFlaw::kKind;
  const auto* const curve =
      std::ranges::find_if(kCurves, [&](const Curve& each) { return Is(*oid, each.oid); });
  if (curve == kCurves.end()) return KeyFlaw::kKind;
  if (point.empty()) return KeyFlaw::kMalformed;
  std::size_t coordinates = 0;
  if (point[0] == kUncompressed) coordinates = 2;
  if (point[0] == kCompressedEven || point[0] == kCompressedOdd) coordinates = 1;
  const bool whole = coordinates > 0 && point.size() == 1 + coordinates * curve->field_bytes;
  return whole ? KeyFlaw::kNone : KeyFlaw::kMalformed;
}

/// The bits of a positive number in its shortest form; nothing for other bytes.
std::optional<std::size_t> BitsOf(Bytes number) {
  constexpr std::uint8_t kSign = 0x80;
  if (number.empty() || (number[0] & kSign) != 0) return std::nullopt;
  if (number[0] == 0) {
    // A leading zero is allowed only to keep the number positive.
    if (number.size() < 2 || (number[1] & kSign) == 0) return std::nullopt;
    number = number.subspan(1);
  }
  return number.size() * 8 - static_cast<std::size_t>(std::countl_zero(number[0]));
}

KeyFlaw FlawOfRsa(Bytes key) {
  DerReader outer(key);
  const auto content = outer.Take(DerTag::kSequence);
  if (!content || !outer.empty()) return KeyFlaw::kMalformed;
  DerReader numbers(*content);
  const auto modulus = numbers.Take(DerTag::kInteger);
  const auto exponent = numbers.Take(DerTag::kInteger);
  if (!modulus || !exponent || !numbers.empty()) return KeyFlaw::kMalformed;
  const auto modulus_bits = BitsOf(*modulus);
  const auto exponent_bits = BitsOf(*exponent);
  if (!modulus_bits || !exponent_bits) return KeyFlaw::kMalformed;
  const bool small = *modulus_bits <= kRsaBitsMax && *exponent_bits <= kRsaExponentBitsMax;
  return small ? KeyFlaw::kNone : KeyFlaw::kSize;
}

bool AreNull(DerReader parameters) {
  const auto null = parameters.Take(DerTag::kNull);
  return null && null->empty() && parameters.empty();
}

bool ArePss(DerReader parameters) {
  const auto content = parameters.Take(DerTag::kSequence);
  return content && content->size() <= kPssParametersBytesMax && parameters.empty();
}

}  // namespace

KeyFlaw FlawOfKey(Bytes info) {
  DerReader parts(info);
  const auto algorithm = parts.Take(DerTag::kSequence);
  const auto bits = parts.Take(DerTag::kBits);
  if (!algorithm || !bits || !parts.empty()) return KeyFlaw::kMalformed;
  // The first byte says how many bits of the last one are unused: it must be zero.
  if (bits->empty() || bits->front() != 0) return KeyFlaw::kMalformed;
  const Bytes key = bits->subspan(1);
  DerReader parameters(*algorithm);
  const auto oid = parameters.Take(DerTag::kOid);
  if (!oid) return KeyFlaw::kMalformed;
  if (Is(*oid, kEcKey)) return FlawOfPoint(parameters, key);
  if (Is(*oid, kRsa)) {
    return parameters.empty() || AreNull(parameters) ? FlawOfRsa(key) : KeyFlaw::kMalformed;
  }
  if (Is(*oid, kRsaPss)) {
    return parameters.empty() || ArePss(parameters) ? FlawOfRsa(key) : KeyFlaw::kMalformed;
  }
  const bool is_25519 = Is(*oid, kEd25519);
  if (!is_25519 && !Is(*oid, kEd448)) return KeyFlaw::kKind;
  const bool whole = key.size() == (is_25519 ? kEd25519Bytes : kEd448Bytes);
  return parameters.empty() && whole ? KeyFlaw::kNone : KeyFlaw::kMalformed;
}

}  // namespace uplink::identity
