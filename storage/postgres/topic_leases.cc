#include "storage/topic_leases.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/postgres/own_connection.h"
#include "storage/postgres/parts.h"
#include "storage/read_row.h"

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

class PostgresTopicLeases final : public TopicLeases {
 public:
  PostgresTopicLeases(std::unique_ptr<OwnConnection> connection, const ProcessId& process)
      : process_(process), connection_(std::move(connection)) {}

  absl::StatusOr<std::optional<Epoch>> Take(const TakeRequest& request) override {
    absl::Status bad = CheckRequest(request);
    if (!bad.ok()) return bad;
    Array prefixes{Type::kText}, processes{Type::kUuid}, counters{Type::kInt8};
    for (const std::string& prefix : request.prefixes) prefixes.Text(prefix);
    for (const OverHolder& over : request.over) {
      processes.Uuid(model::SessionId(over.process));
      counters.Int8(over.lease_counter);
    }
    const auto taken = connection_->Write(
        StoreCallOf(kTake, request.client_id, &prefixes, process_, &processes, &counters,
                    request.at, std::int64_t{DeliveriesKept(request.unacked_max)},
                    kTopicClientsMax),
        "take the lease of topics");
    if (!taken.ok()) return taken.status();
    if (taken->Null(0, 0)) return std::optional<Epoch>();
    return std::optional(static_cast<Epoch>(taken->Int(0, 0)));
  }
  absl::Status Release(std::string_view client_id) override {
    return connection_
        ->Write(StoreCallOf(kRelease, client_id, process_), "release the lease of topics")
        .status();
  }
  absl::StatusOr<std::vector<TopicLease>> Read() override {
    const auto rows = connection_->Write(StoreCallOf(kRead), "read who holds topics");
    if (!rows.ok()) return rows.status();
    std::vector<TopicLease> leases;
    for (const ResultRow& row : *rows) AddTopicLease(row, leases);
    return leases;
  }
  absl::StatusOr<DeliveryMemory> MemoryOf(std::string_view client_id) override {
    const auto rows =
        connection_->Write(StoreCallOf(kDeliveries, client_id, std::int64_t{kDeliveriesMax}),
                           "read what was delivered");
    if (!rows.ok()) return rows.status();
    return storage::MemoryOf(rows->All(DeliveryIn<ResultRow>));
  }
  std::uint64_t connections() const override { return connection_->connections(); }

 private:
  const ProcessId process_;
  const std::unique_ptr<OwnConnection> connection_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<TopicLeases>> MakeTopicLeases(const StoreOptions& options,
                                                             const Clock& clock) {
  return MakeOverOwn<PostgresTopicLeases>(options, clock, options.process);
}

}  // namespace uplink::storage::postgres
