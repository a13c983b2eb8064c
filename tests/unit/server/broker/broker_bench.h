#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/broker/commits.h"
#include "server/broker/intake.h"
#include "server/broker/limits.h"
#include "server/broker/twin_streams.h"
#include "server/journal/journal.h"
#include "server/journal/shards.h"
#include "server/journal/turns.h"
#include "server/log/rate_limited.h"
#include "tests/support/fake_leases.h"
#include "tests/support/fake_store.h"
#include "tests/support/kept_connections.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::broker {

using metrics::Became;

inline constexpr const char* kTwin = "11111111-2222-4333-8444-555555555555";
inline constexpr const char* kOtherTwin = "22222222-2222-4333-8444-555555555555";

/// Where streams learn of commits; a test looks when it wants to.
class KeptWakes final : public loop::WakeInbox {
 public:
  void Wake(std::uint64_t stream) override {
    const std::lock_guard lock(mutex_);
    woken_.push_back(stream);
  }
  [[nodiscard]] std::vector<std::uint64_t> Take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(woken_, {});
  }

 private:
  std::mutex mutex_;
  std::vector<std::uint64_t> woken_;
};

struct BenchLimits {
  std::size_t twins_max = 100;
  std::size_t robots_max = 100;
  journal::JournalLimits journal = {};
};

/// One process that takes a broker's messages, on the store in memory, without a broker.
class Bench {
 public:
  Bench(testing::FakeDatabase& database, std::uint8_t process, const BenchLimits& limits = {})
      : process_{process},
        leases_(database, process_),
        store(database, process_),
        fleet(clock, limits.robots_max, {}, {.timeout = std::chrono::seconds(20)}),
        twins(limits.twins_max),
        journal_(store, limits.journal, clock, uplinks, journal_probe_, process_),
        shards_({&journal_}),
        streams({.clock = clock,
                 .fleet = fleet,
                 .journals = shards_,
                 .twins = twins,
                 .inbox = wakes_,
                 .fleet_name = "arms",
                 .random = [this] { return ++drawn_ * 0x9E3779B97F4A7C15ULL + process_[0]; },
                 .reports = &kept.reports()}),
        commits({.streams = streams,
                 .ledger = ledger,
                 .probe = probe,
                 .clock = clock,
                 .journals = shards_,
                 .committed = [this](std::size_t /*shard*/) { answered_ = true; }}),
        intake({.clock = clock,
                .fleet = fleet,
                .twins = twins,
                .streams = streams,
                .commits = commits,
                .ledger = ledger,
                .probe = probe,
                .refused_log = log_,
                .limited_log = limited_log_,
                .terms = {.prefixes = {"", "site/a/"}},
                .payload_bytes_max = 65'536,
                .journal_over_half = [this] { return over_half; },
                .publish =
                    [this](const mqtt::Outgoing& message) {
                      published.push_back(message);
                      return true;
                    },
                .allowances = allowances_}) {}

  /// Takes the lease; false if another has it.
  bool TakeLease(std::vector<storage::OverHolder> over = {}) {
    const auto epoch = leases_.Take({.client_id = "uplinkd",
                                     .prefixes = {"", "site/a/"},
                                     .over = std::move(over),
                                     .at = clock.System(),
                                     .unacked_max = kRememberedWindow});
    if (!epoch.ok() || !*epoch) return false;
    commits.Begin(std::make_shared<const storage::TopicHold>(storage::TopicHold{
                      .client_id = "uplinkd", .epoch = **epoch, .unacked_max = kRememberedWindow}),
                  *leases_.MemoryOf("uplinkd"));
    return true;
  }

  struct Options {
    std::uint16_t id = 0;
    bool dup = false;
    bool again = false;
    bool retained = false;
    /// Of the delivery; 0: nothing to release.
    std::uint64_t handle = 0;
  };
  Intake::Processed Publish(const std::string& topic, const std::string& payload,
                            const Options& options) {
    mqtt::Message message;
    message.publish.topic = topic;
    message.publish.payload = payload;
    message.publish.payload_bytes = payload.size();
    message.publish.id = options.id;
    message.publish.qos = options.id == 0 ? mqtt::Qos::kAtMostOnce : mqtt::Qos::kAtLeastOnce;
    message.publish.dup = options.dup;
    message.publish.retained = options.retained;
    message.again = options.again;
    if (options.handle != 0) message.ack = mqtt::AckHandle{1, options.handle};
    return intake.Process(message, {clock.Steady(), clock.System()});
  }
  Intake::Processed Publish(const std::string& topic, const std::string& payload) {
    return Publish(topic, payload, Options());
  }
  static std::string Of(const std::string& tail, const char* twin = kTwin) {
    return std::string("cyberwave/twin/") + twin + "/" + tail;
  }
  static std::string Event(int number) {
    return R"({"type":"camera_on","number":)" + std::to_string(number) + "}";
  }

  /// The journal does all that it can; then its streams are looked at.
  void Run() {
    Write();
    Look();
  }
  void Write() {
    while (journal_.turns().Advance() == journal::Step::kWorked) {
    }
  }
  void Remember(storage::Deliveries deliveries) { journal_.Remember(std::move(deliveries)); }
  void Look() {
    for (const std::uint64_t stream : wakes_.Take()) commits.OnWake(stream);
    if (std::exchange(answered_, false)) commits.OnCommitted(0);
  }
  /// The store is asked again what it knows of deliveries, under the same lease.
  void Reread(FaultsByRobot faults) {
    commits.BeginReread();
    streams.BeginReread();
    commits.Reread(*leases_.MemoryOf("uplinkd"));
    streams.SetFaults(std::move(faults));
  }
  /// What one robot may have stored.
  void SetFlow(const robot::FlowLimits& flow) { allowances_.Set({.flow = flow}); }
  /// The handles of what may be acked since the last call.
  std::vector<std::uint64_t> Acked() {
    std::vector<std::uint64_t> acked;
    for (const mqtt::AckHandle& handle : commits.TakeReleases()) acked.push_back(handle.number);
    return acked;
  }
  [[nodiscard]] std::uint64_t Count(Became became) const {
    return ledger.Read().messages.*metrics::kBecame.at(static_cast<std::size_t>(became)).count;
  }
  [[nodiscard]] robot::Presence PresenceOf(const std::string& ruri) const {
    return fleet.Find(ruri)->state.presence();
  }

  /// What was logged, from the first line on.
  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

  testing::ManualClock clock;
  testing::KeptConnections kept{clock};

 private:
  const storage::ProcessId process_;
  testing::FakeTopicLeases leases_;
  journal::JournalProbe journal_probe_;
  std::uint64_t drawn_ = 0;
  bool answered_ = false;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock, log::Format::kText,
                      log::Level::kInfo};
  log::RateLimited log_{logger_};
  LimitedLog limited_log_{logger_};
  KeptWakes wakes_;

 public:
  testing::FakeStore store;
  metrics::Ledger uplinks;
  metrics::Ledger ledger;
  BrokerProbe probe;
  fleet::Fleet fleet;
  cyberwave::Twins twins;

 private:
  journal::Journal journal_;
  journal::Shards shards_;
  ingest::Allowances allowances_;

 public:
  TwinStreams streams;
  Commits commits;
  Intake intake;
  bool over_half = false;
  std::vector<mqtt::Outgoing> published;
};

inline std::string RuriOf(const char* twin, const char* kind = "twin") {
  return std::string("rcan://local.rcan/cyberwave/") + kind + "/" + twin;
}

}  // namespace uplink::broker
