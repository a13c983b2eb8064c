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

/// From which robot and when a record or gap came, and what it costs while it waits. Moved only.
struct Origin {
  robot::ClientRef client;
  /// The client's when the record's stream began.
  std::uint64_t generation = 0;
  SteadyTime arrived;
  std::size_t bytes = 0;
  /// Counts it for the gateway that its stream came through.
  GatewayPlace place{};
  /// It was part of a commit without an answer, which may have been carried out.
  bool tried = false;
  /// The robot's next entry comes of the same message: one commit has both.
  bool continues = false;
  /// Of a drone, judged under a claim that the store answered (storage::SampleMark).
  bool is_sample = false;

  /// A fence overtook it: it must not be written.
  [[nodiscard]] bool IsVoid() const { return generation != client->generation(); }
};

/// What a record holds while it waits, in bytes: its payload and its decoded body, and what the
/// queue needs besides.
[[nodiscard]] std::size_t CostOf(const storage::CommitRecord& record);
[[nodiscard]] std::size_t CostOf(std::size_t payload_bytes, const model::Record& record);
[[nodiscard]] std::size_t CostOf(std::size_t payload_bytes, const model::Rejection& rejection);

/// A record or gap that waits for its commit.
struct Entry {
  Origin origin;
  std::variant<storage::CommitRecord, storage::GapItem> item;
};

/// What goes with all that one stream appends. A value.
struct AppendedBy {
  AppendedBy(std::uint64_t its_generation,  // NOLINT(google-explicit-constructor): without gateway
             GatewayRef its_gateway = nullptr)
      : generation(its_generation), gateway(std::move(its_gateway)) {}

  /// The client's when the stream began (RobotSessions::Begin).
  std::uint64_t generation;
  /// Which gateway the stream came through (Journal::GatewayOf).
  GatewayRef gateway;
};

}  // namespace uplink::journal
