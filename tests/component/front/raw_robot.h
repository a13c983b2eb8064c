#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "schema/model/ids.h"
#include "tests/component/front/front_client.h"

namespace uplink::testing {

/// An honest robot with one session on raw connections, one after the other: it sends each batch
/// once the one before was acked, and goes on where the server says that it is.
///
/// Thread: one at a time.
class RawRobot final {
 public:
  static constexpr std::size_t kBatch = 4;

  RawRobot(RawHttp2::Options options, std::string ruri, std::uint8_t session);

  /// A new connection, and a stream of this session on it; false if no Welcome comes. What it was
  /// on before is cut.
  [[nodiscard]] bool Connect();
  /// Sends a batch; false if the stream ends before it was acked.
  [[nodiscard]] bool StreamBatch();
  /// Ends the call as an agent should; true if the server ends it well.
  [[nodiscard]] bool HalfClose();
  /// Resets the stream, and leaves.
  void Reset();
  /// Leaves without a word.
  void Cut() { client_.reset(); }

  [[nodiscard]] model::Seq acked() const { return acked_; }
  [[nodiscard]] const std::string& ruri() const { return ruri_; }
  [[nodiscard]] model::SessionId session() const { return SessionOf(session_); }

 private:
  static constexpr std::uint32_t kStream = 1;

  const RawHttp2::Options options_;
  const std::string ruri_;
  const std::uint8_t session_;
  model::Seq acked_ = 0;
  std::unique_ptr<RawHttp2> client_;
};

}  // namespace uplink::testing
