#include "storage/topic_leases.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/read_row.h"
#include "storage/sqlite/connections.h"
#include "storage/sqlite/parts.h"

namespace uplink::storage::sqlite {
namespace {

class SqliteTopicLeases final : public TopicLeases {
 public:
  SqliteTopicLeases(SideConnection side, const ProcessId& process)
      : side_(std::move(side)), process_(process) {}

  [[nodiscard]] absl::Status Prepare();

  absl::StatusOr<std::optional<Epoch>> Take(const TakeRequest& request) override {
    absl::Status bad = CheckRequest(request);
    if (!bad.ok()) return bad;
    return side_.database->InTransaction([&] { return TakeInTransaction(request); });
  }
  absl::Status Release(std::string_view client_id) override {
    return side_.database
        ->InTransaction([&]() -> absl::StatusOr<bool> {
          const auto held = release_->Select(client_id, process_).Count();
          if (!held.ok()) return held.status();
          if (*held == 0) return false;
          absl::Status dropped = drop_prefixes_->Run(client_id);
          if (!dropped.ok()) return dropped;
          return true;
        })
        .status();
  }
  absl::StatusOr<std::vector<TopicLease>> Read() override {
    std::vector<TopicLease> leases;
    absl::Status read =
        read_->Select().ForEach([&leases](const Rows& row) { AddTopicLease(row, leases); });
    if (!read.ok()) return read;
    return leases;
  }
  absl::StatusOr<DeliveryMemory> MemoryOf(std::string_view client_id) override {
    return side_.database->InTransaction([&] { return ReadMemory(client_id); });
  }

 private:
  absl::StatusOr<std::optional<Epoch>> TakeInTransaction(const TakeRequest& request);
  absl::StatusOr<Epoch> DrawEpoch();
  absl::Status End(const TopicLease& lease);
  absl::Status Hold(const TakeRequest& request);
  absl::Status NumberDeliveries(const TakeRequest& request);
  absl::StatusOr<DeliveryMemory> ReadMemory(std::string_view client_id);

  SideConnection side_;
  const ProcessId process_;
  std::unique_ptr<Statement> read_, draw_epoch_, end_, take_, drop_prefixes_, add_prefix_, release_,
      insert_, drop_through_, drop_clients_, drop_deliveries_, deliveries_;
};

absl::Status SqliteTopicLeases::Prepare() {
  Preparer prepare(*side_.database);
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

absl::StatusOr<Epoch> SqliteTopicLeases::DrawEpoch() {
  const absl::StatusOr<std::int64_t> epoch = draw_epoch_->Select().OnlyInt();
  if (!epoch.ok()) return epoch.status();
  return static_cast<Epoch>(*epoch);
}

absl::StatusOr<std::optional<Epoch>> SqliteTopicLeases::TakeInTransaction(
    const TakeRequest& request) {
  const absl::StatusOr<std::vector<TopicLease>> leases = Read();
  if (!leases.ok()) return leases.status();
  // There are no leases of processes: the one that has the file is the only one.
  const auto renewed_since = [](const ProcessId&, std::uint64_t) { return false; };
  std::optional<Epoch> epoch;
  for (const TopicLease& lease : *leases) {
    if (IsInTheWay(lease, request, process_, renewed_since)) return std::optional<Epoch>();
    const bool mine = lease.client_id == request.client_id && lease.holder == process_;
    if (mine && !lease.released) epoch = lease.epoch;
  }
  absl::Status status;
  for (const TopicLease& lease : *leases) {
    if (status.ok() && IsEndedBy(lease, request)) status = End(lease);
  }
  if (status.ok() && !epoch) {
    const absl::StatusOr<Epoch> drawn = DrawEpoch();
    if (!drawn.ok()) return drawn.status();
    epoch = *drawn;
    status = take_->Run(request.client_id, process_, *epoch, request.at);
    if (status.ok()) status = NumberDeliveries(request);
  }
  if (status.ok()) status = Hold(request);
  if (status.ok()) status = drop_clients_->Run(kTopicClientsMax);
  if (status.ok()) status = drop_deliveries_->Run();
  if (!status.ok()) return status;
  return epoch;
}

absl::Status SqliteTopicLeases::End(const TopicLease& lease) {
  const absl::StatusOr<Epoch> epoch = DrawEpoch();
  if (!epoch.ok()) return epoch.status();
  absl::Status status = end_->Run(lease.client_id, *epoch);
  return status.ok() ? drop_prefixes_->Run(lease.client_id) : status;
}

absl::Status SqliteTopicLeases::Hold(const TakeRequest& request) {
  absl::Status status = drop_prefixes_->Run(request.client_id);
  for (const std::string& prefix : request.prefixes) {
    if (status.ok()) status = add_prefix_->Run(prefix, request.client_id);
  }
  return status;
}

absl::Status SqliteTopicLeases::NumberDeliveries(const TakeRequest& request) {
  absl::StatusOr<DeliveryMemory> before = ReadMemory(request.client_id);
  if (!before.ok()) return before.status();
  const std::uint64_t last = before->last_number;
  absl::Status status;
  const DeliveryMemory anew = NumberedAnew(*std::move(before), DeliveriesKept(request.unacked_max));
  for (const Delivery& delivery : anew.known) {
    if (status.ok()) {
      status = insert_->Run(request.client_id, delivery.number, std::int64_t{delivery.packet_id},
                            *delivery.digest);
    }
  }
  return status.ok() ? drop_through_->Run(request.client_id, last) : status;
}

absl::StatusOr<DeliveryMemory> SqliteTopicLeases::ReadMemory(std::string_view client_id) {
  const auto deliveries = deliveries_->Select(client_id).All(DeliveryIn<Rows>);
  if (!deliveries.ok()) return deliveries.status();
  return storage::MemoryOf(*deliveries);
}

}  // namespace

absl::StatusOr<std::unique_ptr<TopicLeases>> OpenTopicLeases(const std::string& path,
                                                             const ProcessId& process,
                                                             DamagePtr damage) {
  return MakeOnSideConnection<SqliteTopicLeases>(path, std::move(damage), process);
}

}  // namespace uplink::storage::sqlite
