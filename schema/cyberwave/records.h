#pragma once

#include <cstddef>

#include "schema/model/cyberwave/head.h"
#include "schema/model/cyberwave/reports.h"
#include "schema/model/cyberwave/runs.h"
#include "schema/model/cyberwave/uuid.h"
#include "schema/model/mission.h"
#include "schema/model/record.h"
#include "schema/model/reports.h"
#include "schema/model/scope_update.h"

namespace uplink::cyberwave {

/// Makes records of what JudgeMessage found good: the same kinds that robots on the relay report,
/// so that journal, store and views need not know who spoke. Times are those of the publisher's
/// clock. Pure; any thread.
class Records final {
 public:
  /// A message for people. Debug lines and levels that we do not know are `info`, critical ones are
  /// `error`; the detail says which they were. `payload_bytes` is the size of the payload as it
  /// came.
  [[nodiscard]] static model::Record Of(model::cyberwave::DriverLog log,
                                        const model::cyberwave::Head& head,
                                        std::size_t payload_bytes);
  // What a durable message that was found good became on the way here; `payload_bytes` as above.
  [[nodiscard]] static model::Record Of(model::EventTelemetry event, std::size_t payload_bytes);
  [[nodiscard]] static model::Record Of(model::Message message, std::size_t payload_bytes);
  [[nodiscard]] static model::Record Of(model::MissionRunStatus run, std::size_t payload_bytes);
  [[nodiscard]] static model::Record Of(model::Fault fault, std::size_t payload_bytes);
  /// Of the environment or workflow run that the topic names, which is no robot: so it is no record
  /// of one either.
  [[nodiscard]] static model::ScopeUpdate Of(model::cyberwave::ScopeUpdate update,
                                             const model::cyberwave::Uuid& id,
                                             const model::cyberwave::Head& head);
};

}  // namespace uplink::cyberwave
