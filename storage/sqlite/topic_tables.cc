#include "storage/sqlite/topic_tables.h"

#include <optional>

#include "storage/sqlite/prepare.h"

namespace uplink::storage::sqlite {
namespace {

Blob BlobOf(const std::optional<DeliveryDigest>& digest) {
  if (!digest) return {};
  return {std::string_view(reinterpret_cast<const char*>(digest->data()), digest->size())};
}

}  // namespace

absl::Status TopicTables::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(epoch_, "SELECT epoch FROM topic_clients WHERE client_id = ?");
  prepare.Into(insert_,
               "INSERT INTO deliveries (client_id, number, packet_id, digest) VALUES (?, ?, ?, ?)"
               " ON CONFLICT (client_id, number) DO NOTHING");
  prepare.Into(erase_, "DELETE FROM deliveries WHERE client_id = ? AND number = ?");
  prepare.Into(forget_, "DELETE FROM deliveries WHERE client_id = ? AND number < ?");
  prepare.Into(
      set_forgotten_,
      "UPDATE topic_clients SET forget_below = max(forget_below, ?2) WHERE client_id = ?1");
  return prepare.status();
}

absl::StatusOr<Epoch> TopicTables::LeaseEpoch(std::string_view client_id) {
  Rows rows = epoch_->Select(client_id);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  return *found ? static_cast<Epoch>(rows.Int(0)) : Epoch{0};
}

absl::Status TopicTables::Write(const Deliveries& deliveries) {
  const std::string_view client_id = deliveries.hold->client_id;
  absl::Status status;
  if (deliveries.forget_below > 0) {
    status = set_forgotten_->Run(client_id, deliveries.forget_below);
    if (status.ok()) status = forget_->Run(client_id, deliveries.forget_below);
  }
  for (const Delivery& delivery : deliveries.committed) {
    if (status.ok()) {
      status = insert_->Run(client_id, delivery.number, std::int64_t{delivery.packet_id},
                            BlobOf(delivery.digest));
    }
    if (!status.ok()) return status;
    if (delivery.number <= deliveries.kept_max) continue;
    status = erase_->Run(client_id, delivery.number - deliveries.kept_max);
  }
  return status;
}

}  // namespace uplink::storage::sqlite
