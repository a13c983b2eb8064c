#include "server/broker/message_cost.h"

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

std::optional<model::Rejection> LimitOf(const cyberwave::Judgement& judgement, TwinStream& stream,
                                        std::size_t records, cyberwave::JournalFill fill,
                                        SteadyTime now) {
  if (auto limited = stream.rates->Limit(judgement, fill, now)) return limited;
  const bool faults = judgement.topic.kind == TopicKind::kMetrics &&
                      judgement.rejection() == nullptr && records > 0;
  return faults ? stream.rates->LimitFaults(records, now) : std::nullopt;
}

}  // namespace uplink::broker
