#include "server/journal/entry.h"

#include "schema/model/held_bytes.h"
#include "server/robot/limits.h"

namespace uplink::journal {

std::size_t CostOf(std::size_t payload_bytes, const model::Record& record) {
  return robot::kRecordOverheadBytes + payload_bytes + model::HeldBytes(record);
}

std::size_t CostOf(std::size_t payload_bytes, const model::Rejection& rejection) {
  return robot::kRecordOverheadBytes + payload_bytes + model::HeldBytes(rejection);
}

std::size_t CostOf(const storage::CommitRecord& record) {
  std::size_t payload_bytes = record.payload.size();
  // A sample's memory is shared by its records; the first has the payload.
  if (record.sample != nullptr && payload_bytes > 0) payload_bytes += record.sample->last.size();
  if (const auto* good = std::get_if<model::Record>(&record.content)) {
    return CostOf(payload_bytes, *good);
  }
  if (const auto* update = std::get_if<model::ScopeUpdate>(&record.content)) {
    return robot::kRecordOverheadBytes + payload_bytes + model::HeldBytes(*update);
  }
  if (const auto* request = std::get_if<model::OperatorRequest>(&record.content)) {
    return robot::kRecordOverheadBytes + payload_bytes + model::HeldBytes(*request);
  }
  if (std::holds_alternative<storage::LimitedRange>(record.content)) {
    return robot::kRecordOverheadBytes;
  }
  return CostOf(payload_bytes, std::get<storage::QuarantineItem>(record.content).rejection);
}

}  // namespace uplink::journal
