#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "schema/cyberwave/judge.h"
#include "schema/model/cyberwave/runs.h"
#include "schema/model/cyberwave/uuid.h"
#include "schema/model/mission.h"
#include "schema/model/reports.h"

namespace uplink::cyberwave {

/// What every kind of event begins with: `cyberwave/connected`.
inline constexpr std::string_view kEventPrefix = "cyberwave/";

/// An event of the robot's history, in the sender's own form. A value.
struct EventRecord {
  /// The publisher's clock, Unix milliseconds; 0 if unknown. So in all records.
  std::int64_t unix_time_ms = 0;
  /// kEventPrefix and the vendor's type.
  std::string kind;
  /// The whole payload, as the JSON text of an object.
  std::string detail_json;

  friend bool operator==(const EventRecord&, const EventRecord&) = default;
};

/// A line of a driver's log: a text for people, and what else the driver said with it. A value.
struct LogRecord {
  model::Message message;
  /// All but the message, as the JSON text of an object. It stands beside the message because
  /// model::Message has no place for it; once it has one, it moves there, from here alone.
  std::string detail_json;

  friend bool operator==(const LogRecord&, const LogRecord&) = default;
};

/// A change of an environment or a workflow run, which belong to no robot. A value.
struct ScopeRecord {
  std::int64_t unix_time_ms = 0;
  model::cyberwave::Uuid id;
  model::cyberwave::ScopeUpdate update;

  friend bool operator==(const ScopeRecord&, const ScopeRecord&) = default;
};

/// What is to be stored before a message is acked. A value.
using DurableRecord =
    std::variant<EventRecord, LogRecord, model::MissionRunStatus, model::Fault, ScopeRecord>;

/// The record of a durable message; nothing for any other. The judgement's body is moved from.
[[nodiscard]] std::optional<DurableRecord> TakeRecord(Judgement& judgement);

/// How people are to be warned by a line of that level: debug and unknown ones are informational.
[[nodiscard]] model::MessageLevel MessageLevelOf(model::cyberwave::LogLevel level);

}  // namespace uplink::cyberwave
