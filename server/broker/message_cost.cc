#include "server/broker/message_cost.h"

#include <algorithm>

#include "schema/model/held_bytes.h"

namespace uplink::broker {

using cyberwave::TopicKind;

std::size_t RecordsAtMost(const cyberwave::Judgement& judgement, const TwinStream& stream) {
  if (judgement.rejection() != nullptr ||
      judgement.message_class == cyberwave::MessageClass::kDurable) {
    return 1;
  }
  const bool metrics = judgement.topic.kind == TopicKind::kMetrics && stream.twin != nullptr;
  return metrics ? stream.twin->RecordsAtMost(judgement) : 0;
}

std::size_t FlowBytes(std::size_t payload_bytes, std::span<const storage::CommitRecord> records) {
  std::size_t held = 0;
  for (const storage::CommitRecord& record : records) {
    if (std::holds_alternative<storage::QuarantineItem>(record.content)) return 0;
    if (const auto* good = std::get_if<model::Record>(&record.content)) {
      held += model::HeldBytes(*good);
    } else if (const auto* update = std::get_if<model::ScopeUpdate>(&record.content)) {
      held += model::HeldBytes(*update);
    }
  }
  return std::max(payload_bytes, held);
}

std::optional<model::Rejection> LimitOf(const cyberwave::Judgement& judgement, TwinStream& stream,
                                        std::size_t records, cyberwave::JournalFill fill,
                                        SteadyTime now) {
  if (auto limited = stream.rates->Limit(judgement, fill, now)) return limited;
  const bool faults = judgement.topic.kind == TopicKind::kMetrics &&
                      judgement.rejection() == nullptr && records > 0;
  return faults ? stream.rates->LimitFaults(records, now) : std::nullopt;
}

}  // namespace uplink::broker
