#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/certificates.h"

namespace uplink::bench {

/// Robots that send durable messages as fast as acks let them.
struct RelayShape {
  std::uint16_t port = 0;
  std::string server_ca;
  /// A robot each.
  std::vector<testing::KeyPair> identities;
  std::size_t frame_messages = 64;
  /// Messages that one robot has on its way.
  std::size_t ahead = 4096;
  std::size_t text_bytes = 120;
};

/// Streams over mutual TLS, a connection and two threads each, with as little work as gRPC allows.
///
/// Thread: confined to the thread that made it.
class RelayLoad final {
 public:
  /// Connects and begins. Aborts where the server refuses.
  explicit RelayLoad(const RelayShape& shape);
  /// Cancels the streams.
  ~RelayLoad();
  RelayLoad(const RelayLoad&) = delete;
  RelayLoad& operator=(const RelayLoad&) = delete;

  /// Messages that were acked as durable so far.
  [[nodiscard]] std::uint64_t acked() const;

 private:
  class Stream;
  std::vector<std::unique_ptr<Stream>> streams_;
};

/// One robot that sends one fault report and waits for its Ack, again and again. Returns how long
/// each took, in milliseconds, sorted.
[[nodiscard]] std::vector<double> MeasureAcks(const RelayShape& shape, std::size_t count);

}  // namespace uplink::bench
