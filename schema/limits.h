#pragma once

#include <cstddef>
#include <cstdint>

#include "schema/base/utf8.h"
#include "schema/model/ids.h"

/// The fixed numbers of judgement (the validation sheet's defaults); what an operator may change is
/// in schema::JudgeLimits. Bytes are bytes of UTF-8, without Cap'n Proto's closing NUL.
namespace uplink::schema {

// Framing
/// Words a message may make us visit, as a multiple of its size: shared pointers and lists of empty
/// structs cannot amplify beyond it. A message of the vendor's, however small, has 0.99 times its
/// size to visit at most (its 92 vectors of both generations), and of a geometry each pointer is
/// followed twice: so no message needs a floor.
inline constexpr std::size_t kTraversalFactor = 8;
/// Depth of pointers; a multi polygon, our deepest, needs 7.
inline constexpr int kNestingMax = 32;
/// Segments of one message; Cap'n Proto's own stream readers stop there too (serialize.c++).
inline constexpr std::size_t kSegmentsMax = 512;
/// Largest command for a robot: the largest shape fits, whatever its texts.
inline constexpr std::size_t kCommandBytesMax = std::size_t{256} * 1024;
/// Largest payload whose buffer is kept between calls.
inline constexpr std::size_t kKeptBufferBytesMax = std::size_t{64} * 1024;

// Items
inline constexpr std::size_t kSettingsMax = 256;
inline constexpr std::size_t kCapabilitiesMax = 256;
inline constexpr std::size_t kEStopIdsMax = 32;
inline constexpr std::size_t kShapePositionsMax = 8192;
/// Lines and rings of one shape.
inline constexpr std::size_t kShapePartsMax = 256;
inline constexpr std::size_t kLinePositionsMin = 2;
/// A ring may come closed or open.
inline constexpr std::size_t kRingPositionsMin = 3;

// Texts
inline constexpr std::size_t kIdBytesMax = 128;
inline constexpr std::size_t kNameBytesMax = 256;
inline constexpr std::size_t kDescriptionBytesMax = 4096;
inline constexpr std::size_t kMessageTextBytesMax = 8192;

/// The form in which texts come to judgement.
enum class TextForm : std::uint8_t {
  /// By a robot: a text is as long as its limit at most.
  kAsSent,
  /// As this server keeps them, from a checkpoint: where a control character had one byte, its
  /// replacement has three.
  kAsKept,
  /// By this server, to other robots: as kept, and an id may be followed by `@` and a RURI.
  kAsForwarded,
};

/// Configurable limits of judgement.
struct JudgeLimits {
  /// Largest shape, uiCapabilities and currentSettings payload (limits.payload_bytes_max).
  std::size_t payload_bytes_max = 256 * 1024;
  /// Largest payload of every other variant (limits.message_bytes_max).
  std::size_t message_bytes_max = 64 * 1024;
  /// Most readings in one telemetryExtras (limits.extras_items_max).
  std::size_t extras_items_max = 256;
  /// What limits of texts are judged by.
  TextForm texts = TextForm::kAsSent;
};

/// Bytes that a text may have in that form.
[[nodiscard]] constexpr std::size_t TextBytesMax(TextForm form, std::size_t bytes_max) {
  if (form == TextForm::kAsSent) return bytes_max;
  const std::size_t kept_bytes_max = bytes_max * kReplacementBytes;
  return form == TextForm::kAsKept ? kept_bytes_max : kept_bytes_max + 1 + model::kRuriBytesMax;
}

// Violations
/// Dropped fields of one message that are listed, each with its path and a sentence. Further ones
/// are dropped as well, and counted by their reason alone: a message full of invalid fields costs
/// no more than a good one, and keeps all that is good in it.
inline constexpr std::size_t kDroppedFieldsListedMax = 16;

// Numbers
/// 2100-01-01T00:00:00Z: times from here on are taken as unknown.
inline constexpr std::int64_t kTimeMsEnd = 4'102'444'800'000;
inline constexpr double kPercentMax = 100;
/// How far beyond 0..100 a percentage is still noise, and clamped.
inline constexpr double kPercentSlack = 5;
inline constexpr double kLatitudeDegMax = 90;
inline constexpr double kLongitudeDegMax = 180;
inline constexpr double kAltitudeMMin = -12'000;
inline constexpr double kAltitudeMMax = 100'000;
inline constexpr double kLinearMpsMax = 1000;
inline constexpr double kAngularRpsMax = 1000;
inline constexpr double kTemperatureCMin = -273.15;
inline constexpr double kTemperatureCMax = 1000;
inline constexpr std::uint16_t kProgressX100Max = 10'000;

static_assert(kIdBytesMax < kNameBytesMax && kNameBytesMax < kDescriptionBytesMax &&
              kDescriptionBytesMax < kMessageTextBytesMax);
static_assert(kMessageTextBytesMax < kKeptBufferBytesMax, "a message for people must fit");
static_assert(kNameBytesMax == model::kAgentVersionBytesMax,
              "agentInfo and Hello carry the same agent version");
static_assert(kShapePartsMax * kRingPositionsMin <= kShapePositionsMax,
              "as many rings as allowed must be able to hold their least positions");
static_assert(kShapePositionsMax * 2 * sizeof(double) < std::size_t{256} * 1024,
              "the largest shape must fit a payload");
static_assert(kShapePositionsMax * 2 * sizeof(double) + kShapePartsMax * 4 * sizeof(double) +
                      3 * TextBytesMax(TextForm::kAsForwarded, kNameBytesMax) <
                  kCommandBytesMax,
              "the largest shape must fit a command");
static_assert(kPercentSlack < kPercentMax && kAltitudeMMin < kAltitudeMMax &&
              kTemperatureCMin < kTemperatureCMax);

}  // namespace uplink::schema
