#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

// The bytes of DER, as tests write them by hand, right and wrong.
namespace uplink::testing::der {

/// One element. Its length is DER's shortest.
[[nodiscard]] std::string Element(std::uint8_t tag, std::string_view content);
[[nodiscard]] std::string Sequence(std::string_view content);
[[nodiscard]] std::string Set(std::string_view content);
/// A positive number by its bytes, the highest first.
[[nodiscard]] std::string Integer(std::string_view bytes);
/// An object identifier by its encoded content.
[[nodiscard]] std::string Oid(std::string_view content);
[[nodiscard]] std::string Bits(std::string_view bytes);
[[nodiscard]] std::string Octets(std::string_view bytes);
[[nodiscard]] std::string Null();

}  // namespace uplink::testing::der
