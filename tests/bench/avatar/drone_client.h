#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"
#include "tests/bench/avatar/samples.h"
#include "tests/bench/load/client.h"
#include "tools/link/http2_link.h"

namespace uplink::bench {

/// What became of the calls of a window. A value.
struct CallTally {
  /// From the write of a call to its answer; in milliseconds, by whether the sample is durable.
  std::vector<double> live_ms;
  std::vector<double> durable_ms;
  /// Calls that ended with another status than OK.
  std::uint64_t failed = 0;
  /// Calls with OK, whose sample was neither applied nor stored.
  std::uint64_t not_taken = 0;
  /// Of the first of both.
  std::string example;
};

/// What the drones of a load share; outlives them.
struct DroneWorld {
  const Clock& clock;
  /// Each drone publishes these in turn, and starts at another one.
  std::vector<AvatarSample> samples;
  CallTally tally;
};

/// A drone as cheap as it can be: each call is a record of TLS with headers, request and end of
/// stream, however many are under way. acked() counts the calls that were answered, whatever the
/// answer was.
///
/// Thread: confined to the loop's thread.
class DroneClient final : public Client, private link::LinkUser {
 public:
  struct Who {
    /// Tells drones apart.
    std::size_t number = 0;
    /// Through a gateway: the drone's RURI.
    std::string uav_id = {};
  };
  /// `authority` is HTTP's.
  DroneClient(DroneWorld& world, std::shared_ptr<link::Http2Link> link, std::string authority,
              Who who);
  ~DroneClient() override;
  DroneClient(const DroneClient&) = delete;
  DroneClient& operator=(const DroneClient&) = delete;

  /// So many calls, of a sample each.
  void Send(std::size_t messages) override;
  [[nodiscard]] std::size_t unsent() const override { return link_->link().unsent(); }

 private:
  class Call;

  void OnUp() override { ready_ = !failed_; }
  void OnSent() override { Moved(); }
  void OnDown(const absl::Status& why) override { Fail(std::string(why.message())); }
  void AfterBytes() override {}
  void Soon() override {}

  [[nodiscard]] AvatarMetadata NextMetadata();
  void Settle(Call& call);

  DroneWorld& world_;
  const std::shared_ptr<link::Http2Link> link_;
  const std::string authority_;
  const Who who_;
  const SystemTime began_;
  /// As many as were ever under way at once, and those that are not.
  std::vector<std::unique_ptr<Call>> calls_;
  std::vector<Call*> free_;
};

}  // namespace uplink::bench
