#pragma once

#include <cstddef>
#include <optional>

#include "schema/base/clock.h"
#include "schema/cyberwave/judge.h"
#include "schema/model/rejection.h"
#include "server/broker/twin_stream.h"
#include "server/cyberwave/twin_rates.h"

namespace uplink::broker {

/// How many records the message may bring; they must have room before anything of it is done.
[[nodiscard]] std::size_t RecordsAtMost(const cyberwave::Judgement& judgement,
                                        const TwinStream& stream);

/// Why the twin sends too much, if it does; else its tokens are taken for a message that may bring
/// so many records.
[[nodiscard]] std::optional<model::Rejection> LimitOf(const cyberwave::Judgement& judgement,
                                                      TwinStream& stream, std::size_t records,
                                                      cyberwave::JournalFill fill, SteadyTime now);

}  // namespace uplink::broker
