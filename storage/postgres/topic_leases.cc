#include "storage/postgres/topic_leases.h"

#include <cstdint>
#include <string>
#include <utility>

#include "storage/postgres/own_connection.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kTake =
    "SELECT uplinkd.take_topics($1::text, $2::text[], $3::uuid, $4::uuid[], $5::bigint[],"
    " $6::timestamptz, $7::bigint, $8::bigint)";
constexpr std::string_view kRelease =
    "WITH mine AS (UPDATE uplinkd.topic_clients SET released = true"
    " WHERE client_id = $1::text AND process = $2::uuid RETURNING client_id)"
    " DELETE FROM uplinkd.topic_prefixes AS p USING mine WHERE p.client_id = mine.client_id";
constexpr std::string_view kRead =
    "SELECT c.client_id, c.process, c.epoch, c.released, c.taken_at, p.prefix"
    " FROM uplinkd.topic_clients AS c"
    " LEFT JOIN uplinkd.topic_prefixes AS p ON p.client_id = c.client_id"
    " ORDER BY c.client_id, p.prefix";
// From the last number down, so that rows which went are not looked at.
constexpr std::string_view kDeliveries =
    "SELECT number, packet_id, digest FROM uplinkd.deliveries WHERE client_id = $1::text"
    " AND number > (SELECT l.number FROM uplinkd.deliveries AS l WHERE l.client_id = $1::text"
    " ORDER BY l.number DESC LIMIT 1) - $2::bigint ORDER BY number";

}  // namespace

struct PostgresTopicLeases::Impl {
  ProcessId process;
  std::unique_ptr<OwnConnection> connection;
};

PostgresTopicLeases::PostgresTopicLeases(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PostgresTopicLeases::~PostgresTopicLeases() = default;

absl::StatusOr<std::unique_ptr<PostgresTopicLeases>> PostgresTopicLeases::Make(
    const StoreOptions& options, const Clock& clock) {
  absl::StatusOr<std::unique_ptr<OwnConnection>> connection = OwnConnection::Make(options, clock);
  if (!connection.ok()) return connection.status();
  return std::unique_ptr<PostgresTopicLeases>(new PostgresTopicLeases(
      std::make_unique<Impl>(Impl{options.process, *std::move(connection)})));
}

absl::StatusOr<std::optional<Epoch>> PostgresTopicLeases::Take(const TakeRequest& request) {
  absl::Status bad = CheckRequest(request);
  if (!bad.ok()) return bad;
  Array prefixes{Type::kText}, processes{Type::kUuid}, counters{Type::kInt8};
  for (const std::string& prefix : request.prefixes) prefixes.Text(prefix);
  for (const OverHolder& over : request.over) {
    processes.Uuid(model::SessionId(over.process));
    counters.Int8(over.lease_counter);
  }
  StoreCall take{kTake, {}};
  take.parameters.Text(request.client_id);
  take.parameters.Add(std::move(prefixes));
  take.parameters.Uuid(model::SessionId(impl_->process));
  take.parameters.Add(std::move(processes));
  take.parameters.Add(std::move(counters));
  take.parameters.Time(request.at);
  take.parameters.Int8(std::int64_t{DeliveriesKept(request.unacked_max)});
  take.parameters.Int8(static_cast<std::int64_t>(kTopicClientsMax));
  const auto taken = impl_->connection->Write(std::move(take), "take the lease of topics");
  if (!taken.ok()) return taken.status();
  if (taken->Null(0, 0)) return std::optional<Epoch>();
  return std::optional(static_cast<Epoch>(taken->Int(0, 0)));
}

absl::Status PostgresTopicLeases::Release(std::string_view client_id) {
  StoreCall release{kRelease, {}};
  release.parameters.Text(client_id);
  release.parameters.Uuid(model::SessionId(impl_->process));
  return impl_->connection->Write(std::move(release), "release the lease of topics").status();
}

absl::StatusOr<std::vector<TopicLease>> PostgresTopicLeases::Read() {
  const auto rows = impl_->connection->Write(StoreCall{kRead, {}}, "read who holds topics");
  if (!rows.ok()) return rows.status();
  std::vector<TopicLease> leases;
  for (int row = 0; row < rows->rows(); ++row) {
    if (leases.empty() || leases.back().client_id != rows->Bytes(row, 0)) {
      TopicLease& lease = leases.emplace_back();
      lease.client_id = rows->Bytes(row, 0);
      lease.holder = rows->Uuid(row, 1).bytes();
      lease.epoch = static_cast<Epoch>(rows->Int(row, 2));
      lease.released = rows->Bool(row, 3);
      lease.taken_at = rows->Time(row, 4);
    }
    if (!rows->Null(row, 5)) leases.back().prefixes.emplace_back(rows->Bytes(row, 5));
  }
  return leases;
}

absl::StatusOr<DeliveryMemory> PostgresTopicLeases::MemoryOf(std::string_view client_id) {
  StoreCall read{kDeliveries, {}};
  read.parameters.Text(client_id);
  read.parameters.Int8(std::int64_t{kDeliveriesMax});
  const auto rows = impl_->connection->Write(std::move(read), "read what was delivered");
  if (!rows.ok()) return rows.status();
  std::vector<Delivery> deliveries(static_cast<std::size_t>(rows->rows()));
  for (int row = 0; row < rows->rows(); ++row) {
    Delivery& delivery = deliveries[static_cast<std::size_t>(row)];
    delivery.number = static_cast<std::uint64_t>(rows->Int(row, 0));
    delivery.packet_id = static_cast<std::uint16_t>(rows->Int(row, 1));
    if (!rows->Null(row, 2)) delivery.digest = rows->Uuid(row, 2).bytes();
  }
  return storage::MemoryOf(deliveries);
}

std::uint64_t PostgresTopicLeases::connections() const { return impl_->connection->connections(); }

}  // namespace uplink::storage::postgres
