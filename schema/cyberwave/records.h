#pragma once

#include <optional>
#include <string_view>
#include <variant>

#include "schema/cyberwave/judge.h"
#include "schema/model/record.h"
#include "schema/model/scope_update.h"

namespace uplink::cyberwave {

/// What every kind of event begins with: `cyberwave/connected`.
inline constexpr std::string_view kEventPrefix = "cyberwave/";

/// What is stored before a message is acked: of a robot, or of an environment or a workflow run,
/// which is none. The alternatives are those of storage::CommitContent.
using DurableRecord = std::variant<model::Record, model::ScopeUpdate>;

/// Makes records of what JudgeMessage found good: the same kinds that robots on the relay report,
/// so that journal, store and views need not know who spoke. Times are those of the publisher's
/// clock, 0 if unknown. Pure; any thread.
class Records final {
 public:
  /// The record of a durable message; nothing for any other. The body is moved from.
  ///
  /// Marks and events are events of kind `cyberwave/<type>` with the payload as detail. Lines of a
  /// driver's log are messages for people with the rest as detail: debug lines and levels that we
  /// do not know are `info`, critical ones are `error`; the detail says which they were.
  /// Navigations and missions are runs; a status that we do not know begins the run's message.
  [[nodiscard]] static std::optional<DurableRecord> Take(Judgement& judgement);

  /// A fault that the errors of that message's metrics raise or clear (server/cyberwave).
  [[nodiscard]] static DurableRecord Of(model::Fault fault, std::size_t payload_bytes);
};

}  // namespace uplink::cyberwave
