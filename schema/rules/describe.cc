#include "schema/rules/describe.h"

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

/// The path of a violation of the message as a whole.
constexpr Path kWhole;

std::string Quoted(std::string_view text) { return PrintableUtf8(text, kQuotedBytesMax); }

}  // namespace

model::Rejection Violation::Describe() const {
  std::string detail = sentence(*this);
  if (detail.size() > model::kDetailBytesMax) {
    detail = PrintableUtf8(detail, model::kDetailBytesMax);
  }
  return {.reason = reason, .field = path->Text(), .detail = std::move(detail)};
}

model::Rejection Violation::DescribeUnquoted() const {
  return {.reason = reason,
          .field = path->Text(Path::Keys::kHidden),
          .detail = "nothing of it is quoted, since such a message may hold secrets"};
}

Violation Malformed(std::string_view why) {
  return {.reason = RejectReason::kMalformed,
          .path = &kWhole,
          .sentence =
              [](const Violation& self) {
                return PrintableUtf8(fmt::format("not a readable message: {}", self.texts[0]),
                                     model::kDetailBytesMax);
              },
          .texts = {why}};
}

Violation PositionsWithoutData(const Path& path, std::size_t count) {
  return {.reason = RejectReason::kMalformed,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("{} positions without coordinates", self.counts[0]);
              },
          .counts = {count}};
}

Violation TooDeep(const Path& path, std::size_t depth_max) {
  return {.reason = RejectReason::kMalformed,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("nested deeper than the {} levels that are allowed",
                                   self.counts[0]);
              },
          .counts = {depth_max}};
}

Violation UnknownVariant(const Path& path, unsigned member) {
  return {.reason = RejectReason::kUnknownVariant,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("union member {} is unknown", self.counts[0]);
              },
          .counts = {member}};
}

Violation WithoutKind(const Path& path) {
  return {.reason = RejectReason::kUnknownVariant,
          .path = &path,
          .sentence = [](const Violation& self) {
            return fmt::format("{} has no kind, or one that is unknown", self.path->Text());
          }};
}

Violation PayloadTooLarge(std::size_t bytes, std::size_t bytes_max) {
  return {.reason = RejectReason::kPayloadTooLarge,
          .path = &kWhole,
          .sentence =
              [](const Violation& self) {
                return fmt::format("payload has {} bytes, at most {} are allowed", self.counts[0],
                                   self.counts[1]);
              },
          .counts = {bytes, bytes_max}};
}

Violation TooManyItems(const Path& path, std::size_t count, std::size_t max,
                       std::string_view what) {
  return {.reason = RejectReason::kTooManyItems,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("{} {}, at most {} are allowed", self.counts[0], self.texts[0],
                                   self.counts[1]);
              },
          .counts = {count, max},
          .texts = {what}};
}

Violation TooFewItems(const Path& path, std::size_t count, std::size_t min, std::string_view what) {
  return {.reason = RejectReason::kTooFewItems,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("{} {}, at least {} are needed", self.counts[0], self.texts[0],
                                   self.counts[1]);
              },
          .counts = {count, min},
          .texts = {what}};
}

Violation TextTooLong(const Path& path, std::size_t bytes, std::size_t bytes_max) {
  return {.reason = RejectReason::kTextTooLong,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("text has {} bytes, at most {} are allowed", self.counts[0],
                                   self.counts[1]);
              },
          .counts = {bytes, bytes_max}};
}

Violation TextNotUtf8(const Path& path, std::string_view text) {
  return {.reason = RejectReason::kTextNotUtf8,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("text is not UTF-8 without NUL: \"{}\"", Quoted(self.texts[0]));
              },
          .texts = {text}};
}

Violation PayloadNotUtf8() {
  return {
      .reason = RejectReason::kTextNotUtf8,
      .path = &kWhole,
      .sentence = [](const Violation& /*self*/) {
        return std::string("the payload is not UTF-8 without NUL and halves of surrogate pairs");
      }};
}

Violation MissingField(const Path& path, std::string_view what) {
  return {.reason = RejectReason::kMissingField,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                const std::string field = self.path->Text();
                return fmt::format("{} {}", field.empty() ? "the message" : field, self.texts[0]);
              },
          .texts = {what}};
}

Violation OutOfRange(const Path& path, double value, double min, double max) {
  return {.reason = RejectReason::kOutOfRange,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("{} lies outside {} to {}", self.numbers[0], self.numbers[1],
                                   self.numbers[2]);
              },
          .numbers = {value, min, max}};
}

Violation BelowZero(const Path& path, double value) {
  return {.reason = RejectReason::kOutOfRange,
          .path = &path,
          .sentence =
              [](const Violation& self) { return fmt::format("{} is below 0", self.numbers[0]); },
          .numbers = {value}};
}

Violation MinAboveMax(const Path& path, double min, double max) {
  return {.reason = RejectReason::kOutOfRange,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("the minimum {} is above the maximum {}", self.numbers[0],
                                   self.numbers[1]);
              },
          .numbers = {min, max}};
}

Violation NotFinite(const Path& path, double value) {
  return {.reason = RejectReason::kNotFinite,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("{} is not a finite number", self.numbers[0]);
              },
          .numbers = {value}};
}

Violation BeyondDouble() {
  return {.reason = RejectReason::kNotFinite,
          .path = &kWhole,
          .sentence = [](const Violation& /*self*/) {
            return std::string("a number is beyond a double");
          }};
}

Violation TypeMismatch(const Path& path, std::string_view type, std::string_view declared) {
  return {.reason = RejectReason::kTypeMismatch,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("the value is of type {}, declared is {}", self.texts[0],
                                   self.texts[1]);
              },
          .texts = {type, declared}};
}

Violation DuplicateKey(const Path& path, std::string_view key) {
  return {.reason = RejectReason::kDuplicateKey,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("\"{}\" stands twice in its list", Quoted(self.texts[0]));
              },
          .texts = {key}};
}

Violation IdentityMismatch(const Path& path, std::string_view said, std::string_view own) {
  return {.reason = RejectReason::kIdentityMismatch,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return PrintableUtf8(fmt::format("\"{}\" is not the stream's robot \"{}\"",
                                                 self.texts[0], self.texts[1]),
                                     model::kDetailBytesMax);
              },
          .texts = {said, own}};
}

Violation TopicMismatch(const Path& path, std::string_view said, std::string_view own) {
  return {.reason = RejectReason::kIdentityMismatch,
          .path = &path,
          .sentence =
              [](const Violation& self) {
                return fmt::format("\"{}\" is not the topic's \"{}\"", Quoted(self.texts[0]),
                                   Quoted(self.texts[1]));
              },
          .texts = {said, own}};
}

}  // namespace uplink::schema
