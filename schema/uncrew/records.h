#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "schema/model/operator_request.h"
#include "schema/model/record.h"
#include "schema/uncrew/judge.h"

namespace uplink::uncrew {

/// Faults, and rows of quarantine, that drones cause have this source.
inline constexpr std::string_view kFaultSource = "uncrew";

/// What is stored before a sample is answered. The alternatives are some of
/// storage::CommitContent.
using DurableRecord = std::variant<model::Record, model::OperatorRequest>;

/// What a store remembers of a type's last stored sample, so that the next one tells what changed:
/// the request itself, for sets and for what is durable on change; else nothing. Pure.
[[nodiscard]] std::string_view MemoryOf(model::uncrew::SampleType type, std::string_view request);

/// A sample that was stored. A value.
struct Recalled {
  model::uncrew::Value value;
  model::uncrew::Metadata metadata;
};
/// The sample in such a memory; nothing if it is empty, or no rule lets it pass any more. Pure.
[[nodiscard]] std::optional<Recalled> Recall(model::uncrew::SampleType type,
                                             std::string_view memory);

/// Makes records of what Judge found good: the same kinds that other robots report, so that
/// journal, store and views need not know who spoke. Pure; any thread.
class Records final {
 public:
  /// The records of a sample, given what the one stored before it said (Recall; null: nothing).
  /// Empty for a live sample, for a set or a mode that says the same, and for a rejected one.
  ///
  /// A status text is a message for people; an error, a connection, a command's result and a change
  /// of mode are events (`error`, `connection`, `commandResult`, `armed`, `flightMode`,
  /// `uncrewFlightMode`, `missionItem`; a change as {from, to}, without `from` if nothing is
  /// known). Alerts that are new or gone raise and clear faults, requests open and close.
  [[nodiscard]] static std::vector<DurableRecord> Of(const Judgement& judged,
                                                     const model::uncrew::Value* before);
};

}  // namespace uplink::uncrew
