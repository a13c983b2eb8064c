#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "schema/model/rejection.h"
#include "schema/rules/path.h"

namespace uplink::schema {

/// A violation as it was found, not yet in words: most that follow the first ones of a message are
/// only counted. It refers to its path and texts, and must not outlive them. A
/// value.
struct Violation {
  model::RejectReason reason;
  const Path* path;
  /// The sentence that names value and limit.
  std::string (*sentence)(const Violation& self);
  // What the sentence is about.
  std::array<double, 3> numbers{};
  std::array<std::size_t, 2> counts{};
  std::array<std::string_view, 2> texts{};

  /// In words; it allocates.
  [[nodiscard]] model::Rejection Describe() const;
  /// In words that show nothing which the sender wrote, neither values nor keys: of messages that
  /// may hold secrets.
  [[nodiscard]] model::Rejection DescribeUnquoted() const;
};

// One function per violation. `path` is where it was found; without one, the message as a whole.

[[nodiscard]] Violation Malformed(std::string_view why);
/// A list of so many positions that has no bytes for any of them.
[[nodiscard]] Violation PositionsWithoutData(const Path& path, std::size_t count);
/// What is nested deeper than may be.
[[nodiscard]] Violation TooDeep(const Path& path, std::size_t depth_max);
[[nodiscard]] Violation UnknownVariant(const Path& path, unsigned member);
/// Of a union that is not set, or set to a member that is unknown.
[[nodiscard]] Violation WithoutKind(const Path& path);
[[nodiscard]] Violation PayloadTooLarge(std::size_t bytes, std::size_t bytes_max);
[[nodiscard]] Violation TooManyItems(const Path& path, std::size_t count, std::size_t max,
                                     std::string_view what);
[[nodiscard]] Violation TooFewItems(const Path& path, std::size_t count, std::size_t min,
                                    std::string_view what);
[[nodiscard]] Violation TextTooLong(const Path& path, std::size_t bytes, std::size_t bytes_max);
[[nodiscard]] Violation TextNotUtf8(const Path& path, std::string_view text);
/// A payload that is no text as a whole. It quotes nothing: what it is of may be secret.
[[nodiscard]] Violation PayloadNotUtf8();
/// `what` is what is missing, such as "is empty" or "is a null pointer".
[[nodiscard]] Violation MissingField(const Path& path, std::string_view what);
[[nodiscard]] Violation OutOfRange(const Path& path, double value, double min, double max);
[[nodiscard]] Violation BelowZero(const Path& path, double value);
[[nodiscard]] Violation MinAboveMax(const Path& path, double min, double max);
[[nodiscard]] Violation NotFinite(const Path& path, double value);
/// A number in a JSON text that no double holds.
[[nodiscard]] Violation BeyondDouble();
[[nodiscard]] Violation TypeMismatch(const Path& path, std::string_view type,
                                     std::string_view declared);
[[nodiscard]] Violation DuplicateKey(const Path& path, std::string_view key);
/// `said` is the RURI that the message names, `own` that of its stream's robot.
[[nodiscard]] Violation IdentityMismatch(const Path& path, std::string_view said,
                                         std::string_view own);
/// `said` is what the message names, `own` what the topic that it came on names.
[[nodiscard]] Violation TopicMismatch(const Path& path, std::string_view said,
                                      std::string_view own);

}  // namespace uplink::schema
