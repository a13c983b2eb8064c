#include "schema/rules/describe.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "schema/base/utf8.h"
#include "schema/model/ids.h"

namespace uplink::schema {
namespace {

using model::RejectReason;

/// Foreign text quoted in a detail is cut here, so that the sentence around it survives.
constexpr std::size_t kQuotedBytesMax = 160;
static_assert(kQuotedBytesMax * 2 < model::kDetailBytesMax);

model::Rejection Make(RejectReason reason, const Path& path, std::string detail) {
  if (detail.size() > model::kDetailBytesMax) {
    detail = PrintableUtf8(detail, model::kDetailBytesMax);
  }
  return {.reason = reason, .field = path.Text(), .detail = std::move(detail)};
}

}  // namespace

model::Rejection Malformed(std::string_view why) {
  return Make(
      RejectReason::kMalformed, Path(),
      PrintableUtf8(fmt::format("not a readable message: {}", why), model::kDetailBytesMax));
}

model::Rejection UnknownVariant(const Path& path, unsigned member) {
  return Make(RejectReason::kUnknownVariant, path,
              fmt::format("union member {} is unknown", member));
}

model::Rejection PayloadTooLarge(std::size_t bytes, std::size_t bytes_max) {
  return Make(RejectReason::kPayloadTooLarge, Path(),
              fmt::format("payload has {} bytes, at most {} are allowed", bytes, bytes_max));
}

model::Rejection TooManyItems(const Path& path, std::size_t count, std::size_t max,
                              std::string_view what) {
  return Make(RejectReason::kTooManyItems, path,
              fmt::format("{} {}, at most {} are allowed", count, what, max));
}

model::Rejection TooFewItems(const Path& path, std::size_t count, std::size_t min,
                             std::string_view what) {
  return Make(RejectReason::kTooFewItems, path,
              fmt::format("{} {}, at least {} are needed", count, what, min));
}

model::Rejection TextTooLong(const Path& path, std::size_t bytes, std::size_t bytes_max) {
  return Make(RejectReason::kTextTooLong, path,
              fmt::format("text has {} bytes, at most {} are allowed", bytes, bytes_max));
}

model::Rejection TextNotUtf8(const Path& path, std::string_view text) {
  return Make(
      RejectReason::kTextNotUtf8, path,
      fmt::format("text is not UTF-8 without NUL: \"{}\"", PrintableUtf8(text, kQuotedBytesMax)));
}

model::Rejection MissingField(const Path& path, std::string_view what) {
  const std::string field = path.Text();
  return Make(RejectReason::kMissingField, path,
              fmt::format("{} {}", field.empty() ? "the message" : field, what));
}

model::Rejection OutOfRange(const Path& path, double value, double min, double max) {
  return Make(RejectReason::kOutOfRange, path,
              fmt::format("{} lies outside {} to {}", value, min, max));
}

model::Rejection BelowZero(const Path& path, double value) {
  return Make(RejectReason::kOutOfRange, path, fmt::format("{} is below 0", value));
}

model::Rejection MinAboveMax(const Path& path, double min, double max) {
  return Make(RejectReason::kOutOfRange, path,
              fmt::format("the minimum {} is above the maximum {}", min, max));
}

model::Rejection NotFinite(const Path& path, double value) {
  return Make(RejectReason::kNotFinite, path, fmt::format("{} is not a finite number", value));
}

model::Rejection TypeMismatch(const Path& path, std::string_view type, std::string_view declared) {
  return Make(RejectReason::kTypeMismatch, path,
              fmt::format("the value is of type {}, declared is {}", type, declared));
}

model::Rejection DuplicateKey(const Path& path, std::string_view key) {
  return Make(RejectReason::kDuplicateKey, path,
              fmt::format("\"{}\" stands twice in its list", PrintableUtf8(key, kQuotedBytesMax)));
}

}  // namespace uplink::schema
