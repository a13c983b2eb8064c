#include "tests/bench/fair/bad_payloads.h"

#include <cstring>
#include <limits>

#include <fmt/core.h>

#include "schema/base/check.h"
#include "schema/encode.h"
#include "schema/limits.h"

namespace uplink::bench {
namespace {

constexpr std::int64_t kTimeMs = 1'763'683'200'000;
constexpr std::size_t kWordBytes = 8;
constexpr std::size_t kTableEntryBytes = 4;
constexpr char kControl = '\x01';
/// Texts of ControlSettings: with keys and pointers they stay below kLargeShapeBytes.
constexpr std::size_t kControlTexts = 62;

std::uint32_t EntryAt(const std::string& table, std::size_t index) {
  std::uint32_t entry = 0;
  std::memcpy(&entry, table.data() + index * kTableEntryBytes, kTableEntryBytes);
  return entry;
}

/// The same message in exactly `bytes`: its last segment ends with words that nothing refers to.
/// Source: "Serialization Over a Stream" of Cap'n Proto's encoding: the number of segments less
/// one, then the words of each.
std::string PaddedTo(const std::string& payload, std::size_t bytes) {
  UPLINK_CHECK(payload.size() <= bytes && bytes % kWordBytes == 0, "the padding has room");
  const std::size_t last = EntryAt(payload, 0) + 1;
  const auto words = static_cast<std::uint32_t>((bytes - payload.size()) / kWordBytes);
  const std::uint32_t entry = EntryAt(payload, last) + words;
  std::string padded(bytes, '\0');
  payload.copy(padded.data(), payload.size());
  std::memcpy(padded.data() + last * kTableEntryBytes, &entry, kTableEntryBytes);
  return padded;
}

std::string TextMessage(char letter) {
  model::Message message;
  message.unix_time_ms = kTimeMs;
  message.message = std::string(kLongTextBytes, letter);
  return schema::Encode(message);
}

}  // namespace

std::string LargeShape(std::size_t number) {
  model::MultiPoint points;
  points.points.reserve(schema::kShapePositionsMax);
  for (std::size_t i = 0; i < schema::kShapePositionsMax; ++i) {
    points.points.push_back({.lon = 13 + static_cast<double>(i) / 1e5, .lat = 52});
  }
  model::ReportedShape shape;
  shape.identity.id = fmt::format("large-{}", number);
  shape.data = std::move(points);
  return PaddedTo(schema::Encode(model::ShapeOp{std::move(shape)}), kLargeShapeBytes);
}

std::string LongText() { return TextMessage('t'); }

std::string ControlText() { return TextMessage(kControl); }

std::string ControlSettings() {
  model::CurrentSettings settings;
  for (std::size_t i = 0; i < kControlTexts; ++i) {
    settings.settings.push_back(
        {fmt::format("control-{}", i), std::string(schema::kDescriptionBytesMax, kControl)});
  }
  return schema::Encode(settings);
}

std::string Malformed(std::size_t number) {
  std::string payload = GoodEvent(number);
  switch (number % kWaysToBeMalformed) {
    case 0:
      payload.resize(payload.size() / 2);
      return payload;
    case 1:
      return payload.append(kWordBytes, '\0');
    case 2:
      return std::string(payload.size(), '\xA5');
    default:
      return "";
  }
}

std::string FaultyExtras(std::size_t good) {
  UPLINK_CHECK(good <= kFaultyReadings, "no more readings are good than there are");
  model::TelemetryExtras extras;
  extras.unix_time_ms = kTimeMs;
  for (std::size_t i = 0; i < kFaultyReadings; ++i) {
    const bool faulty = i < kFaultyReadings - good;
    extras.kv.push_back({fmt::format("faulty/reading/{}", i),
                         faulty ? std::numeric_limits<double>::quiet_NaN() : 1.0, std::nullopt});
  }
  return schema::Encode(extras);
}

std::string RenamedJoints(std::string_view ruri, std::int64_t timestamp_us,
                          std::uint64_t generation) {
  std::string joints;
  for (std::size_t i = 0; i < kRenamedJoints; ++i) {
    joints += fmt::format(
        R"({}{{"joint":"j{}_{}","timestamp_us":{},"position_rad":0.5,"velocity_rad_s":0.25,)"
        R"("effort_nm":1.5,"temperature_c":40,"error_flags":1}})",
        i == 0 ? "" : ",", generation, i, timestamp_us);
  }
  return fmt::format(R"({{"ruri":"{}","timestamp_us":{},"joints":[{}]}})", ruri, timestamp_us,
                     joints);
}

std::string GoodEvent(std::uint64_t number) {
  model::EventTelemetry event;
  event.unix_time_ms = kTimeMs + static_cast<std::int64_t>(number);
  event.kind = model::MissionStartedEvent{fmt::format("mission-{}", number)};
  return schema::Encode(event);
}

}  // namespace uplink::bench
