#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <variant>

#include "schema/base/clock.h"
#include "server/journal/gateway_use.h"
#include "server/robot/commit_client.h"
#include "storage/batch.h"
#include "storage/commit_record.h"

namespace uplink::journal {

/// Where and when a record or gap came from, and what it costs while it waits. Moved only.
struct Origin {
  robot::ClientRef client;
  /// The client's generation when the record's stream began.
  std::uint64_t generation = 0;
  SteadyTime arrived;
  std::size_t bytes = 0;
  /// Counts it for the gateway that its stream came through.
  GatewayPlace place{};
  /// It was part of a commit without an answer, and may be stored.
  bool tried = false;
  /// The robot's next entry is of the same message: one commit has both.
  bool continues = false;
  /// It is of a drone, and was judged under a claim that the store answered (storage::SampleMark).
  bool is_sample = false;

  /// A fence overtook it: it must not be written.
  [[nodiscard]] bool IsVoid() const { return generation != client->generation(); }
};

/// Bytes of a record while it waits: its payload, its decoded body, and the queue's overhead.
[[nodiscard]] std::size_t CostOf(const storage::CommitRecord& record);
[[nodiscard]] std::size_t CostOf(std::size_t payload_bytes, const model::Record& record);
[[nodiscard]] std::size_t CostOf(std::size_t payload_bytes, const model::Rejection& rejection);

/// A record or gap that waits for its commit.
struct Entry {
  Origin origin;
  std::variant<storage::CommitRecord, storage::GapItem> item;
};

/// The mark of everything that one stream appends. A value.
struct AppendedBy {
  AppendedBy(std::uint64_t its_generation,  // NOLINT(google-explicit-constructor): without gateway
             GatewayRef its_gateway = nullptr)
      : generation(its_generation), gateway(std::move(its_gateway)) {}

  /// The client's when the stream began (RobotSessions::Begin).
  std::uint64_t generation;
  /// The gateway of the stream (Journal::GatewayOf).
  GatewayRef gateway;
};

}  // namespace uplink::journal
