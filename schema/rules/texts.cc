#include "schema/rules/texts.h"

#include <cstdint>
#include <cstring>
#include <utility>

#include "schema/base/utf8.h"
#include "schema/limits.h"
#include "schema/rules/describe.h"

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

std::optional<model::Rejection> TextFault(const Path& path, std::string_view text,
                                          std::size_t bytes_max) {
  if (text.size() > bytes_max) return TextTooLong(path, text.size(), bytes_max);
  if (!IsCleanUtf8(SkipAscii(text))) return TextNotUtf8(path, text);
  return std::nullopt;
}

std::optional<std::string> Text(Faults& faults, const Path& path, std::string_view text,
                                std::size_t bytes_max) {
  if (auto fault = TextFault(path, text, bytes_max)) {
    faults.Content(*std::move(fault));
    return std::nullopt;
  }
  return std::string(text);
}

std::string DurableText(Faults& faults, const Path& path, std::string_view text,
                        std::size_t bytes_max) {
  return Text(faults, path, text, bytes_max).value_or(std::string());
}

std::string RequiredText(Faults& faults, const Path& path, std::string_view text,
                         std::size_t bytes_max) {
  if (text.empty()) faults.Content(MissingField(path, "is empty"));
  return DurableText(faults, path, text, bytes_max);
}

std::string LiveKey(Faults& faults, const Path& path, std::string_view text) {
  if (auto fault = TextFault(path, text, kIdBytesMax)) {
    faults.Reject(*std::move(fault));
    return {};
  }
  return std::string(text);
}

std::string RequiredLiveKey(Faults& faults, const Path& path, std::string_view text) {
  if (text.empty()) faults.Reject(MissingField(path, "is empty"));
  return LiveKey(faults, path, text);
}

std::optional<std::string> CutText(Faults& faults, const Path& path, std::string_view text,
                                   std::size_t bytes_max) {
  if (auto fault = TextFault(path, text, text.size())) {
    faults.Content(*std::move(fault));
    return std::nullopt;
  }
  if (text.size() <= bytes_max) return faults.NewText(text);
  faults.Content(TextTooLong(path, text.size(), bytes_max));
  return faults.NewText(Utf8Prefix(text, bytes_max));
}

}  // namespace uplink::schema
