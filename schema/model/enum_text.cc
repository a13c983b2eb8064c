#include "schema/model/enum_text.h"

#include <charconv>

namespace uplink::model {
namespace {

constexpr std::string_view kPrefix = "unrecognized_";

}  // namespace

std::string UnrecognizedText(std::int32_t number) {
  return std::string(kPrefix) + std::to_string(number);
}

std::optional<std::uint16_t> UnrecognizedFromText(std::string_view text) {
  if (!text.starts_with(kPrefix)) return std::nullopt;
  text.remove_prefix(kPrefix.size());
  std::uint16_t number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || rest != end) return std::nullopt;
  return number;
}

}  // namespace uplink::model
