#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "tests/bench/cyberwave/publishers.h"
#include "tests/bench/cyberwave/subscribers.h"
#include "tests/support/mosquitto.h"

namespace uplink::bench {

/// The broker's lines for all scenarios: nothing is held back or dropped there, and nothing logged
/// for each client.
inline constexpr const char* kBrokerLines =
    "log_type none\nlog_type error\nlog_type information\nset_tcp_nodelay true\n"
    "max_inflight_messages 0\nmax_queued_messages 1000000\n";

/// Who reads, with a broker and publishers of its own. Confined to one thread.
class Side final {
 public:
  /// What is published. A value.
  struct Load {
    std::size_t connections = 1;
    std::vector<PublishPacket> packets;
  };
  /// `make(port)` makes the reader of the broker at that port.
  template <typename Make>
  Side(Make make, Load load, const Clock& clock)
      : broker_({.lines = kBrokerLines}),
        subscriber_(make(broker_.port())),
        publishers_(broker_.port(), load.connections, std::move(load.packets), clock) {}

  [[nodiscard]] Subscriber& subscriber() { return *subscriber_; }
  [[nodiscard]] Publishers& publishers() { return publishers_; }

  /// A moment of both. A value.
  struct Moment {
    SteadyTime at;
    std::uint64_t sent = 0;
    std::uint64_t taken = 0;
    double cpu_seconds = 0;
    std::uint64_t rss_bytes = 0;
  };
  [[nodiscard]] Moment Now(const Clock& clock) {
    const std::uint64_t taken = subscriber_->count();
    const synthetic::ProcessUse use = subscriber_->use();
    return {.at = clock.Steady(),
            .sent = publishers_.sent(),
            .taken = taken,
            .cpu_seconds = use.cpu_seconds,
            .rss_bytes = use.rss_bytes};
  }

  /// Waits until as much was taken since `from` as was sent, or what is missing will not come.
  void WaitTaken(const Moment& from, int looks_max) {
    constexpr milliseconds kLook{100};
    for (int look = 0; look < looks_max; ++look) {
      if (subscriber_->count() - from.taken >= publishers_.sent() - from.sent) return;
      publishers_.Pace(0, kLook);
    }
  }

 private:
  testing::Mosquitto broker_;
  std::unique_ptr<Subscriber> subscriber_;
  Publishers publishers_;
};

}  // namespace uplink::bench
