#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "schema/base/clock.h"
#include "schema/cyberwave/judge.h"
#include "schema/model/rejection.h"
#include "server/broker/twin_stream.h"
#include "server/cyberwave/twin_rates.h"
#include "storage/commit_record.h"

namespace uplink::broker {

/// How many records the message may bring; they must have room before anything of it is done.
[[nodiscard]] std::size_t RecordsAtMost(const cyberwave::Judgement& judgement,
                                        const TwinStream& stream);

/// What the flow counts of these records of one message: the bytes of its payload, or what they
/// hold where that is more, as of any robot's messages (limits.durable_bytes_*). Of a rejected
/// message none: quarantine counts what it keeps of that.
[[nodiscard]] std::size_t FlowBytes(std::size_t payload_bytes,
                                    std::span<const storage::CommitRecord> records);

/// Why the twin sends too much, if it does; else its tokens are taken for a message that may bring
/// so many records.
[[nodiscard]] std::optional<model::Rejection> LimitOf(const cyberwave::Judgement& judgement,
                                                      TwinStream& stream, std::size_t records,
                                                      cyberwave::JournalFill fill, SteadyTime now);

}  // namespace uplink::broker
