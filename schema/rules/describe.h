#pragma once

#include <cstddef>
#include <string_view>

#include "schema/model/rejection.h"
#include "schema/rules/path.h"

namespace uplink::schema {

/// One function a reason: the Rejection with its path and a sentence that names value and limit.
/// Only called once a violation is certain; they allocate.

[[nodiscard]] model::Rejection Malformed(std::string_view why);
[[nodiscard]] model::Rejection UnknownVariant(const Path& path, unsigned member);
[[nodiscard]] model::Rejection PayloadTooLarge(std::size_t bytes, std::size_t bytes_max);
[[nodiscard]] model::Rejection TooManyItems(const Path& path, std::size_t count, std::size_t max,
                                            std::string_view what);
[[nodiscard]] model::Rejection TooFewItems(const Path& path, std::size_t count, std::size_t min,
                                           std::string_view what);
[[nodiscard]] model::Rejection TextTooLong(const Path& path, std::size_t bytes,
                                           std::size_t bytes_max);
[[nodiscard]] model::Rejection TextNotUtf8(const Path& path, std::string_view text);
/// `what` is what is missing, such as "is empty" or "is a null pointer".
[[nodiscard]] model::Rejection MissingField(const Path& path, std::string_view what);
[[nodiscard]] model::Rejection OutOfRange(const Path& path, double value, double min, double max);
[[nodiscard]] model::Rejection BelowZero(const Path& path, double value);
[[nodiscard]] model::Rejection MinAboveMax(const Path& path, double min, double max);
[[nodiscard]] model::Rejection NotFinite(const Path& path, double value);
[[nodiscard]] model::Rejection TypeMismatch(const Path& path, std::string_view type,
                                            std::string_view declared);
[[nodiscard]] model::Rejection DuplicateKey(const Path& path, std::string_view key);

}  // namespace uplink::schema
