#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/model/ids.h"
#include "uplink/v1/relay.pb.h"

// What agents say in tests.
namespace uplink::testing {

/// One message of a batch.
struct Sent {
  model::Seq seq = 0;
  std::string payload;
};

[[nodiscard]] v1::RelayRequest HelloFrame(const model::SessionId& session, model::Seq settled = 0,
                                          model::Seq judged = 0);
[[nodiscard]] v1::RelayRequest BatchFrame(const std::vector<Sent>& messages);

/// A fault report, as an agent encodes it: durable.
[[nodiscard]] std::string FaultPayload(const std::string& fault_id);
/// A motion report: live.
[[nodiscard]] std::string MotionPayload(double lat_deg = 52.0);
/// A session id that `number` tells apart.
[[nodiscard]] model::SessionId SessionOf(std::uint8_t number);
/// A robot's address that `number` tells apart.
[[nodiscard]] std::string RuriOf(int number);

}  // namespace uplink::testing
