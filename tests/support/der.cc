#include "tests/support/der.h"

namespace uplink::testing::der {
namespace {

constexpr std::uint8_t kSequence = 0x30;
constexpr std::uint8_t kSet = 0x31;
constexpr std::uint8_t kInteger = 0x02;
constexpr std::uint8_t kBits = 0x03;
constexpr std::uint8_t kOctets = 0x04;
constexpr std::uint8_t kOid = 0x06;
constexpr std::size_t kShortMax = 0x7F;

}  // namespace

std::string Element(std::uint8_t tag, std::string_view content) {
  std::string length;
  for (std::size_t rest = content.size(); rest > 0; rest >>= 8U) {
    length.insert(length.begin(), static_cast<char>(rest & 0xFFU));
  }
  std::string element(1, static_cast<char>(tag));
  if (content.size() > kShortMax) {
    element += static_cast<char>(0x80U | length.size());
    element += length;
  } else {
    element += static_cast<char>(content.size());
  }
  return element += content;
}

std::string Sequence(std::string_view content) { return Element(kSequence, content); }

std::string Set(std::string_view content) { return Element(kSet, content); }

std::string Integer(std::string_view bytes) {
  while (bytes.size() > 1 && bytes.front() == 0) bytes.remove_prefix(1);
  std::string content(bytes);
  if (content.empty() || (static_cast<std::uint8_t>(content.front()) & 0x80U) != 0) {
    content.insert(content.begin(), '\0');
  }
  return Element(kInteger, content);
}

std::string Oid(std::string_view content) { return Element(kOid, content); }

std::string Bits(std::string_view bytes) {
  return Element(kBits, std::string(1, '\0').append(bytes));
}

std::string Octets(std::string_view bytes) { return Element(kOctets, bytes); }

std::string Null() { return Element(0x05, ""); }

}  // namespace uplink::testing::der
