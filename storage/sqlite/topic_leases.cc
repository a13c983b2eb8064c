#include "storage/sqlite/topic_leases.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "schema/base/check.h"
#include "storage/sqlite/prepare.h"

namespace uplink::storage::sqlite {
namespace {

/// Of a process, or of a message.
Blob BlobOf(const std::array<std::uint8_t, 16>& bytes) {
  return {std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size())};
}

/// Sixteen bytes of a column; zeros for what no program of ours wrote.
template <typename Bytes>
Bytes BytesOf(std::string_view column) {
  Bytes bytes{};
  if (column.size() == bytes.size()) std::copy(column.begin(), column.end(), bytes.begin());
  return bytes;
}

}  // namespace

absl::StatusOr<std::unique_ptr<SqliteTopicLeases>> SqliteTopicLeases::Open(const std::string& path,
                                                                           const ProcessId& process,
                                                                           DamagePtr damage) {
  auto beside = OpenBeside(path, std::move(damage));
  if (!beside.ok()) return beside.status();
  std::unique_ptr<SqliteTopicLeases> leases(new SqliteTopicLeases(*std::move(beside), process));
  absl::Status prepared = leases->Prepare();
  if (!prepared.ok()) return prepared;
  return leases;
}

absl::Status SqliteTopicLeases::Prepare() {
  Preparer prepare(*beside_.database);
  prepare.Into(begin_, "BEGIN IMMEDIATE");
  prepare.Into(commit_, "COMMIT");
  prepare.Into(read_,
               "SELECT c.client_id, c.process, c.epoch, c.released, c.taken_at, p.prefix"
               " FROM topic_clients AS c LEFT JOIN topic_prefixes AS p ON p.client_id = c.client_id"
               " ORDER BY c.client_id, p.prefix");
  prepare.Into(draw_epoch_, "UPDATE epochs SET last = last + 1 WHERE id = 0 RETURNING last");
  prepare.Into(end_, "UPDATE topic_clients SET released = 1, epoch = ?2 WHERE client_id = ?1");
  prepare.Into(take_,
               "INSERT INTO topic_clients (client_id, process, epoch, released, taken_at)"
               " VALUES (?, ?, ?, 0, ?) ON CONFLICT (client_id) DO UPDATE SET"
               " process = excluded.process, epoch = excluded.epoch, released = 0,"
               " taken_at = excluded.taken_at");
  prepare.Into(drop_prefixes_, "DELETE FROM topic_prefixes WHERE client_id = ?");
  prepare.Into(add_prefix_, "INSERT INTO topic_prefixes (prefix, client_id) VALUES (?, ?)");
  prepare.Into(release_,
               "UPDATE topic_clients SET released = 1 WHERE client_id = ? AND process = ?"
               " RETURNING 1");
  prepare.Into(insert_,
               "INSERT INTO deliveries (client_id, number, packet_id, digest) VALUES (?, ?, ?, ?)");
  prepare.Into(drop_through_, "DELETE FROM deliveries WHERE client_id = ? AND number <= ?");
  prepare.Into(drop_clients_,
               "DELETE FROM topic_clients WHERE client_id IN (SELECT client_id FROM topic_clients"
               " WHERE released ORDER BY taken_at, client_id LIMIT max(0, (SELECT count(*)"
               " FROM topic_clients) - ?))");
  prepare.Into(
      drop_deliveries_,
      "DELETE FROM deliveries WHERE client_id NOT IN (SELECT client_id FROM topic_clients)");
  prepare.Into(deliveries_,
               "SELECT number, packet_id, digest FROM deliveries WHERE client_id = ?"
               " ORDER BY number");
  return prepare.status();
}

template <typename Result, typename Work>
absl::StatusOr<Result> SqliteTopicLeases::InTransaction(const Work& work) {
  absl::Status status = begin_->Run();
  if (!status.ok()) return status;
  absl::StatusOr<Result> result = work();
  status = result.status();
  if (status.ok()) status = commit_->Run();
  if (status.ok()) return result;
  beside_.database->RollbackIfOpen();
  return status;
}

absl::StatusOr<std::vector<TopicLease>> SqliteTopicLeases::Read() {
  std::vector<TopicLease> leases;
  Rows rows = read_->Select();
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return leases;
    if (leases.empty() || leases.back().client_id != rows.Bytes(0)) {
      TopicLease& lease = leases.emplace_back();
      lease.client_id = rows.Bytes(0);
      lease.holder = BytesOf<ProcessId>(rows.Bytes(1));
      lease.epoch = static_cast<Epoch>(rows.Int(2));
      lease.released = rows.Int(3) != 0;
      lease.taken_at = FromUnixMs(rows.Int(4));
    }
    if (!rows.Null(5)) leases.back().prefixes.emplace_back(rows.Bytes(5));
  }
}

absl::StatusOr<Epoch> SqliteTopicLeases::DrawEpoch() {
  Rows rows = draw_epoch_->Select();
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found) return absl::InternalError("the store's count of epochs is gone");
  return static_cast<Epoch>(rows.Int(0));
}

absl::StatusOr<std::optional<Epoch>> SqliteTopicLeases::Take(const TakeRequest& request) {
  absl::Status bad = CheckRequest(request);
  if (!bad.ok()) return bad;
  return InTransaction<std::optional<Epoch>>([&] { return TakeInTransaction(request); });
}

absl::StatusOr<std::optional<Epoch>> SqliteTopicLeases::TakeInTransaction(
    const TakeRequest& request) {
  const absl::StatusOr<std::vector<TopicLease>> leases = Read();
  if (!leases.ok()) return leases.status();
  // There are no leases of processes: whoever has the file is the only one.
  const auto renewed_since = [](const ProcessId&, std::uint64_t) { return false; };
  std::optional<Epoch> epoch;
  for (const TopicLease& lease : *leases) {
    if (IsInTheWay(lease, request, process_, renewed_since)) return std::optional<Epoch>();
    const bool mine = lease.client_id == request.client_id && lease.holder == process_;
    if (mine && !lease.released) epoch = lease.epoch;
  }
  absl::Status status;
  for (const TopicLease& lease : *leases) {
    if (status.ok() && EndsWith(lease, request)) status = End(lease);
  }
  if (status.ok() && !epoch) {
    const absl::StatusOr<Epoch> drawn = DrawEpoch();
    if (!drawn.ok()) return drawn.status();
    epoch = *drawn;
    status = take_->Run(std::string_view(request.client_id), BlobOf(process_), *epoch,
                        UnixMs(request.at));
    if (status.ok()) status = NumberDeliveries(request);
  }
  if (status.ok()) status = Hold(request);
  if (status.ok()) status = drop_clients_->Run(static_cast<std::int64_t>(kTopicClientsMax));
  if (status.ok()) status = drop_deliveries_->Run();
  if (!status.ok()) return status;
  return epoch;
}

absl::Status SqliteTopicLeases::End(const TopicLease& lease) {
  const absl::StatusOr<Epoch> epoch = DrawEpoch();
  if (!epoch.ok()) return epoch.status();
  absl::Status status = end_->Run(std::string_view(lease.client_id), *epoch);
  if (status.ok()) status = drop_prefixes_->Run(std::string_view(lease.client_id));
  return status;
}

absl::Status SqliteTopicLeases::Hold(const TakeRequest& request) {
  absl::Status status = drop_prefixes_->Run(std::string_view(request.client_id));
  for (const std::string& prefix : request.prefixes) {
    if (!status.ok()) return status;
    status = add_prefix_->Run(std::string_view(prefix), std::string_view(request.client_id));
  }
  return status;
}

absl::Status SqliteTopicLeases::NumberDeliveries(const TakeRequest& request) {
  const std::string_view client_id = request.client_id;
  absl::StatusOr<DeliveryMemory> before = ReadMemory(client_id);
  if (!before.ok()) return before.status();
  const std::uint64_t last = before->last_number;
  absl::Status status;
  const DeliveryMemory anew = NumberedAnew(*std::move(before), DeliveriesKept(request.unacked_max));
  for (const Delivery& delivery : anew.known) {
    if (status.ok()) {
      status = insert_->Run(client_id, delivery.number, std::int64_t{delivery.packet_id},
                            BlobOf(*delivery.digest));
    }
  }
  if (status.ok()) status = drop_through_->Run(client_id, last);
  return status;
}

absl::Status SqliteTopicLeases::Release(std::string_view client_id) {
  return InTransaction<bool>([&]() -> absl::StatusOr<bool> {
           Rows rows = release_->Select(client_id, BlobOf(process_));
           absl::StatusOr<bool> held = rows.Next();
           if (!held.ok() || !*held) return held;
           absl::Status dropped = drop_prefixes_->Run(client_id);
           if (!dropped.ok()) return dropped;
           return true;
         })
      .status();
}

absl::StatusOr<DeliveryMemory> SqliteTopicLeases::MemoryOf(std::string_view client_id) {
  return InTransaction<DeliveryMemory>([&] { return ReadMemory(client_id); });
}

absl::StatusOr<DeliveryMemory> SqliteTopicLeases::ReadMemory(std::string_view client_id) {
  std::vector<Delivery> deliveries;
  Rows rows = deliveries_->Select(client_id);
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return storage::MemoryOf(deliveries);
    Delivery& delivery = deliveries.emplace_back();
    delivery.number = static_cast<std::uint64_t>(rows.Int(0));
    delivery.packet_id = static_cast<std::uint16_t>(rows.Int(1));
    if (!rows.Null(2)) delivery.digest = BytesOf<DeliveryDigest>(rows.Bytes(2));
  }
}

}  // namespace uplink::storage::sqlite
