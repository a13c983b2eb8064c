#include "storage/remember.h"

#include <algorithm>
#include <cstddef>

#include "schema/base/check.h"

namespace uplink::storage {
namespace {

/// The outcomes of the records of the message that ends at `place`.
std::span<const Outcome> OutcomesOf(const MessageEnd& end, std::size_t place,
                                    std::span<const Outcome> outcomes) {
  UPLINK_CHECK(end.records >= 1 && end.records <= kMessageRecordsMax && end.records <= place + 1,
               "the records of a message stand in one batch, at most kMessageRecordsMax");
  return outcomes.subspan(place + 1 - end.records, end.records);
}

void Forget(const TopicHold& hold, std::uint64_t number, DeliveryChanges& changes) {
  const std::uint32_t kept = DeliveriesKept(hold.unacked_max);
  if (number > kept) changes.gone.push_back({&hold, number - kept});
}

}  // namespace

absl::StatusOr<DeliveryChanges> DeliveryChangesOf(const Batch& batch,
                                                  std::span<const Outcome> outcomes,
                                                  const LeaseStands& stands) {
  DeliveryChanges changes;
  for (std::size_t place = 0; place < batch.records.size(); ++place) {
    const CommitRecord& record = batch.records[place];
    if (!record.message_end) continue;
    const TopicHold* const hold = HoldOf(record.origin);
    UPLINK_CHECK(hold != nullptr, "a broker's message comes under a lease");
    const absl::StatusOr<bool> stand = stands(*hold);
    if (!stand.ok()) return stand.status();
    if (!*stand) continue;
    const auto of_message = OutcomesOf(*record.message_end, place, outcomes);
    const bool fenced =
        std::ranges::find(of_message, OutcomeKind::kFenced, &Outcome::kind) != of_message.end();
    for (const Delivery& delivery : record.message_end->deliveries) {
      if (!fenced) changes.added.push_back({hold, delivery});
      Forget(*hold, delivery.number, changes);
    }
  }
  for (const Deliveries& deliveries : batch.deliveries) {
    UPLINK_CHECK(deliveries.hold != nullptr, "deliveries come under a lease");
    const absl::StatusOr<bool> stand = stands(*deliveries.hold);
    if (!stand.ok()) return stand.status();
    if (!*stand) continue;
    for (const Delivery& delivery : deliveries.rows) {
      changes.added.push_back({deliveries.hold.get(), delivery});
      Forget(*deliveries.hold, delivery.number, changes);
    }
  }
  return changes;
}

}  // namespace uplink::storage
