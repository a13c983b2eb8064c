#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "schema/rules/faults.h"
#include "schema/rules/path.h"

/// Rules of texts: length in bytes, well-formed UTF-8, no NUL.
namespace uplink::schema {

/// The fault of a text, or nothing.
[[nodiscard]] std::optional<model::Rejection> TextFault(const Path& path, std::string_view text,
                                                        std::size_t bytes_max);

/// The text fit to keep, or nothing after reporting a fault of content.
[[nodiscard]] std::optional<std::string> Text(Faults& faults, const Path& path,
                                              std::string_view text, std::size_t bytes_max);

/// Text for fields that have no absent state: empty if at fault. Only for durable kinds, where the
/// fault rejects the message.
[[nodiscard]] std::string DurableText(Faults& faults, const Path& path, std::string_view text,
                                      std::size_t bytes_max);

/// DurableText that must not be empty.
[[nodiscard]] std::string RequiredText(Faults& faults, const Path& path, std::string_view text,
                                       std::size_t bytes_max);

/// The key of a live message (device, consumable, directive): a fault in it rejects the message.
[[nodiscard]] std::string LiveKey(Faults& faults, const Path& path, std::string_view text);

/// LiveKey that must not be empty.
[[nodiscard]] std::string RequiredLiveKey(Faults& faults, const Path& path, std::string_view text);

/// A text that is cut, not dropped, when it is too long; the cut is reported all the same.
[[nodiscard]] std::optional<std::string> CutText(Faults& faults, const Path& path,
                                                 std::string_view text, std::size_t bytes_max);

}  // namespace uplink::schema
