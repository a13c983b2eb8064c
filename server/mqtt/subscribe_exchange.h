#pragma once

#include <optional>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "server/mqtt/packets.h"
#include "server/mqtt/probe.h"
#include "server/mqtt/subscriptions.h"

namespace uplink::mqtt {

/// Sends SUBSCRIBE and UNSUBSCRIBE on one connection, one at a time, and takes the answers. Pure.
///
/// Thread: confined to its client's; the subscriptions outlive it.
class SubscribeExchange final {
 public:
  /// `retry`: how long until a refused filter is asked for again.
  SubscribeExchange(Version version, Subscriptions& subscriptions, ClientProbe& probe,
                    milliseconds retry)
      : version_(version), subscriptions_(subscriptions), probe_(probe), retry_(retry) {}

  /// The next packet to send; empty while an answer is awaited, or if everything was asked.
  [[nodiscard]] std::string Next(SteadyTime now);
  /// An answer is awaited.
  [[nodiscard]] bool waiting() const { return waiting_; }

  /// The filters that the broker does not serve as asked. Errors: kUnexpectedAnswer.
  [[nodiscard]] Decoded<std::vector<Subscriptions::Lack>> Answered(const Suback& answer);
  [[nodiscard]] std::optional<Fault> Answered(const Unsuback& answer);

  /// When Retry is due; empty if no filter is refused.
  [[nodiscard]] std::optional<SteadyTime> retry_at() const { return retry_at_; }
  /// Asks again for refused filters.
  void Retry();

 private:
  const Version version_;
  Subscriptions& subscriptions_;
  ClientProbe& probe_;
  const milliseconds retry_;
  bool waiting_ = false;
  PacketId id_ = 0;
  std::optional<SteadyTime> retry_at_;
};

/// For people: the filter that is not served as asked, and the broker's reason.
[[nodiscard]] std::string LackText(const Subscriptions::Lack& lack);
/// True if the broker refuses it; otherwise it serves it at a lower QoS.
[[nodiscard]] bool IsRefused(const Subscriptions::Lack& lack);

}  // namespace uplink::mqtt
