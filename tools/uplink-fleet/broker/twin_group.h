#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/broker/link.h"
#include "tools/uplink-fleet/robot/histogram.h"
#include "tools/uplink-fleet/robot/shared.h"
#include "tools/uplink-fleet/twin/script.h"

namespace uplink::synthetic {

/// What twins do: publish; wait until all of it is acked; publish each live value once more and be
/// quiet; leave.
enum class TwinStage : std::uint8_t { kSend, kSettle, kLast, kClose };

/// What the threads of twins and the run tell each other. Thread-safe.
struct TwinsShared {
  std::atomic<TwinStage> stage{TwinStage::kSend};
  /// Give up what is not done.
  std::atomic<bool> abandon{false};
  // Groups that have come to the end of that stage.
  std::atomic<std::size_t> settled_groups{0};
  std::atomic<std::size_t> quiet_groups{0};
  std::atomic<std::uint64_t> connections{0};
  std::atomic<std::uint64_t> breaks{0};
  std::atomic<std::uint64_t> published{0};
  std::atomic<std::uint64_t> published_qos1{0};
  std::atomic<std::uint64_t> acked{0};
  std::atomic<std::uint64_t> skipped{0};
  std::atomic<std::uint64_t> pings{0};
  std::atomic<std::uint64_t> pongs{0};

  FirstText first_error;
};

/// Publications of a group at QoS 1 that are not acked; past it no twin goes on.
inline constexpr std::size_t kGroupUnackedMax = 256;
/// How often a group pings.
inline constexpr milliseconds kPingEvery{1'000};
/// After a connection that ended.
inline constexpr milliseconds kReconnectAfter{500};

/// Which twins speak by one connection, and how. A value.
struct TwinGroupOptions {
  BrokerSettings broker;
  std::uint64_t seed = 1;
  std::string run;
  std::string prefix;
  /// Messages per second and twin.
  double rate_hz = 20;
  /// Twins from `first` on.
  std::size_t first = 0;
  std::size_t twins = 0;
};

/// Some twins and their connection to the broker. Publishes as fast as the rate says and the broker
/// lets it; a connection that ends is opened again.
///
/// Thread: made and asked by one thread; Run is another's until it returns.
class TwinGroup final : private BrokerListener {
 public:
  /// `clock` and `shared` must outlive this. What the settings lack is said by Run.
  TwinGroup(const TwinGroupOptions& options, const Clock& clock, TwinsShared& shared);

  /// Lives through all stages; returns at the end of the last one, or when told to give up.
  void Run();

  [[nodiscard]] const std::vector<std::unique_ptr<TwinScript>>& twins() const { return twins_; }
  [[nodiscard]] const Histogram& pong() const { return pong_; }

 private:
  struct Pending {
    std::size_t twin = 0;
    std::uint64_t number = 0;
  };

  void OnConnected() override;
  void OnAcked(int id, std::string_view refused) override;
  void OnMessage(std::string_view topic, std::string_view payload) override;

  /// Opens the connection if it is time; false if there is none.
  [[nodiscard]] bool Connected(SteadyTime now);
  void Ended(const absl::Status& status);
  void Work(SteadyTime now);
  void EnterStage(TwinStage stage);
  void PublishDue(SteadyTime now);
  [[nodiscard]] bool MayPublish() const;
  [[nodiscard]] bool PublishOf(std::size_t twin);
  void Ping(SteadyTime now);
  [[nodiscard]] bool AllAcked() const;
  [[nodiscard]] bool NothingQueued() const;
  [[nodiscard]] milliseconds UntilDue(SteadyTime now) const;
  [[nodiscard]] std::int64_t NowUs() const;

  const TwinGroupOptions options_;
  const Clock& clock_;
  TwinsShared& shared_;
  const SteadyTime::duration period_;
  std::vector<std::unique_ptr<TwinScript>> twins_;
  /// What a twin says before it goes on with its script.
  std::vector<std::deque<Publication>> queued_;
  std::vector<SteadyTime> due_;
  std::unique_ptr<BrokerLink> link_;
  bool connected_ = false;
  bool opened_ = false;
  SteadyTime connect_at_{};
  std::unordered_map<int, Pending> unacked_;
  TwinStage stage_ = TwinStage::kSend;
  bool told_ = false;
  std::string ping_name_;
  SteadyTime ping_at_{};
  /// The ping that waits for its pong.
  std::optional<SteadyTime> pinged_;
  Histogram pong_;
};

}  // namespace uplink::synthetic
