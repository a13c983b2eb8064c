#include "storage/sqlite/topic_tables.h"

#include <optional>

#include "storage/sqlite/prepare.h"

namespace uplink::storage::sqlite {
namespace {

Blob BlobOf(const std::optional<DeliveryDigest>& digest) {
  if (!digest) return {};
  return {std::string_view(reinterpret_cast<const char*>(digest->data()), digest->size())};
}

Blob BlobOf(const ProcessId& process) {
  return {std::string_view(reinterpret_cast<const char*>(process.data()), process.size())};
}

}  // namespace

absl::Status TopicTables::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(epoch_, "SELECT epoch FROM topic_clients WHERE client_id = ?1 AND process = ?2");
  prepare.Into(insert_,
               "INSERT INTO deliveries (client_id, number, packet_id, digest) VALUES (?, ?, ?, ?)"
               " ON CONFLICT (client_id, number) DO NOTHING");
  prepare.Into(erase_, "DELETE FROM deliveries WHERE client_id = ? AND number = ?");
  return prepare.status();
}

absl::StatusOr<Epoch> TopicTables::LeaseEpoch(std::string_view client_id,
                                              const ProcessId& process) {
  Rows rows = epoch_->Select(client_id, BlobOf(process));
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  return *found ? static_cast<Epoch>(rows.Int(0)) : Epoch{0};
}

absl::Status TopicTables::Write(const DeliveryChanges& changes) {
  for (const auto& [hold, delivery] : changes.added) {
    absl::Status added = insert_->Run(std::string_view(hold->client_id), delivery.number,
                                      std::int64_t{delivery.packet_id}, BlobOf(delivery.digest));
    if (!added.ok()) return added;
  }
  for (const auto& [hold, number] : changes.gone) {
    absl::Status erased = erase_->Run(std::string_view(hold->client_id), number);
    if (!erased.ok()) return erased;
  }
  return absl::OkStatus();
}

}  // namespace uplink::storage::sqlite
