#include "storage/postgres/write/delivery_rows.h"

#include <set>
#include <string_view>
#include <utility>

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kInsert =
    "INSERT INTO uplinkd.deliveries (client_id, number, packet_id, digest)"
    " SELECT * FROM unnest($1::text[], $2::bigint[], $3::int[], $4::uuid[])"
    " ON CONFLICT (client_id, number) DO NOTHING";
constexpr std::string_view kErase =
    "DELETE FROM uplinkd.deliveries AS d USING unnest($1::text[], $2::bigint[])"
    " AS u (client_id, number) WHERE d.client_id = u.client_id AND d.number = u.number";
constexpr std::string_view kHoldTopics =
    "SELECT uplinkd.hold_topics($1::text[], $2::bigint[], $3::uuid)";

}  // namespace

void AddDeliveryCalls(const DeliveryChanges& changes, std::vector<StoreCall>& calls) {
  if (!changes.added.empty()) {
    Array client{Type::kText}, number{Type::kInt8}, packet_id{Type::kInt4}, digest{Type::kUuid};
    for (const auto& [hold, delivery] : changes.added) {
      client.Text(hold->client_id);
      number.Int8(delivery.number);
      packet_id.Int4(delivery.packet_id);
      if (delivery.digest) {
        digest.Uuid(model::SessionId(*delivery.digest));
      } else {
        digest.Null();
      }
    }
    calls.push_back(StoreCallOf(kInsert, &client, &number, &packet_id, &digest));
  }
  if (changes.gone.empty()) return;
  Array client{Type::kText}, number{Type::kInt8};
  for (const auto& [hold, gone] : changes.gone) {
    client.Text(hold->client_id);
    number.Int8(gone);
  }
  calls.push_back(StoreCallOf(kErase, &client, &number));
}

void AddHoldCall(const Batch& batch, const ProcessId& process, std::vector<StoreCall>& calls) {
  std::set<std::pair<std::string_view, Epoch>> holds;
  const auto add = [&holds](const TopicHold* hold) {
    if (hold != nullptr) holds.emplace(hold->client_id, hold->epoch);
  };
  for (const CommitRecord& record : batch.records) add(HoldOf(record.origin));
  for (const Deliveries& deliveries : batch.deliveries) add(deliveries.hold.get());
  if (holds.empty()) return;
  Array clients{Type::kText}, epochs{Type::kInt8};
  for (const auto& [client, epoch] : holds) {
    clients.Text(client);
    epochs.Int8(epoch);
  }
  calls.push_back(StoreCallOf(kHoldTopics, &clients, &epochs, process));
}

}  // namespace uplink::storage::postgres
