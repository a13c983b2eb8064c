#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "schema/cyberwave/records.h"
#include "schema/model/rejection.h"
#include "server/mqtt/packets.h"
#include "storage/commit_record.h"

namespace uplink::broker {

/// What a message brings to the store, without robot, session and number (Commits::Append). Pure.
[[nodiscard]] std::vector<storage::CommitRecord> RecordsOf(
    std::vector<cyberwave::DurableRecord> made, const mqtt::Publish& publish, SystemTime arrived);

/// The row of quarantine of a message that was rejected, with so much of its payload.
[[nodiscard]] std::vector<storage::CommitRecord> RecordsOf(const model::Rejection& rejection,
                                                           const mqtt::Publish& publish,
                                                           SystemTime arrived, std::string payload);

}  // namespace uplink::broker
