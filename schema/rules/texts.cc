#include "schema/rules/texts.h"

#include <cstdint>
#include <cstring>

#include "schema/base/utf8.h"
#include "schema/limits.h"

namespace uplink::schema {
namespace {

/// The text behind its leading eight-byte blocks of ASCII without NUL: most texts are only that.
std::string_view SkipAscii(std::string_view text) {
  constexpr std::uint64_t kHighBits = 0x8080'8080'8080'8080U;
  constexpr std::uint64_t kOnes = 0x0101'0101'0101'0101U;
  while (text.size() >= sizeof(std::uint64_t)) {
    std::uint64_t block = 0;
    std::memcpy(&block, text.data(), sizeof(block));
    // The subtraction sets a high bit where a byte is 0 (or follows one that is).
    if (((block | (block - kOnes)) & kHighBits) != 0) break;
    text.remove_prefix(sizeof(block));
  }
  return text;
}

}  // namespace

std::optional<Violation> TextViolation(const Path& path, std::string_view text,
                                       std::size_t bytes_max) {
  if (text.size() > bytes_max) return TextTooLong(path, text.size(), bytes_max);
  if (!IsCleanUtf8(SkipAscii(text))) return TextNotUtf8(path, text);
  return std::nullopt;
}

std::optional<std::string> Text(Violations& violations, const Path& path, std::string_view text,
                                std::size_t bytes_max) {
  if (const auto violation = TextViolation(path, text, bytes_max)) {
    violations.Content(*violation);
    return std::nullopt;
  }
  return std::string(text);
}

std::string DurableText(Violations& violations, const Path& path, std::string_view text,
                        std::size_t bytes_max) {
  return Text(violations, path, text, bytes_max).value_or(std::string());
}

std::string RequiredText(Violations& violations, const Path& path, std::string_view text,
                         std::size_t bytes_max) {
  if (text.empty()) violations.Content(MissingField(path, "is empty"));
  return DurableText(violations, path, text, bytes_max);
}

std::string LiveKey(Violations& violations, const Path& path, std::string_view text) {
  if (const auto violation = TextViolation(path, text, kIdBytesMax)) {
    violations.Reject(*violation);
    return {};
  }
  return std::string(text);
}

std::string RequiredLiveKey(Violations& violations, const Path& path, std::string_view text) {
  if (text.empty()) violations.Reject(MissingField(path, "is empty"));
  return LiveKey(violations, path, text);
}

std::optional<std::string> CutText(Violations& violations, const Path& path, std::string_view text,
                                   std::size_t bytes_max) {
  if (const auto violation = TextViolation(path, text, text.size())) {
    violations.Content(*violation);
    return std::nullopt;
  }
  if (text.size() <= bytes_max) return violations.NewText(text);
  violations.Content(TextTooLong(path, text.size(), bytes_max));
  return violations.NewText(Utf8Prefix(text, bytes_max));
}

}  // namespace uplink::schema
