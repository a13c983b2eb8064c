#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "schema/rules/describe.h"
#include "schema/rules/path.h"
#include "schema/rules/violations.h"

/// Rules of texts: length in bytes, well-formed UTF-8, no NUL. Control characters other than tab,
/// line feed and carriage return are no violation: what is kept has U+FFFD in their place.
namespace uplink::schema {

/// What one pass over a text found.
struct TextFinding {
  std::optional<Violation> violation;
  /// Control characters to replace.
  std::size_t controls = 0;
};

[[nodiscard]] TextFinding ReadText(const Path& path, std::string_view text, std::size_t bytes_max);

/// A text without violation as it is kept; what is replaced is counted.
[[nodiscard]] std::string KeptText(Violations& violations, std::string_view text,
                                   std::size_t controls);

/// The text fit to keep, or nothing after reporting a violation of content.
[[nodiscard]] std::optional<std::string> Text(Violations& violations, const Path& path,
                                              std::string_view text, std::size_t bytes_max);

/// Text for fields that have no absent state: empty if invalid. Only for durable kinds, where the
/// violation rejects the message.
[[nodiscard]] std::string DurableText(Violations& violations, const Path& path,
                                      std::string_view text, std::size_t bytes_max);

/// DurableText that must not be empty.
[[nodiscard]] std::string RequiredText(Violations& violations, const Path& path,
                                       std::string_view text, std::size_t bytes_max);

/// The key of a live message (device, consumable, directive): a violation in it rejects the
/// message.
[[nodiscard]] std::string LiveKey(Violations& violations, const Path& path, std::string_view text);

/// LiveKey that must not be empty.
[[nodiscard]] std::string RequiredLiveKey(Violations& violations, const Path& path,
                                          std::string_view text);

/// A text that is cut, not dropped, when it is too long; the cut is reported all the same.
[[nodiscard]] std::optional<std::string> CutText(Violations& violations, const Path& path,
                                                 std::string_view text, std::size_t bytes_max);

}  // namespace uplink::schema
