#pragma once

#include <cstddef>

#include "schema/model/cyberwave/head.h"
#include "schema/model/cyberwave/reports.h"
#include "schema/model/record.h"

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
};

}  // namespace uplink::cyberwave
