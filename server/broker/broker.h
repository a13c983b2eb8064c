#pragma once

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "server/broker/broker_health.h"
#include "server/broker/commits.h"
#include "server/broker/connection_log.h"
#include "server/broker/connection_statuses.h"
#include "server/broker/held_back_message.h"
#include "server/broker/intake.h"
#include "server/broker/lease_view.h"
#include "server/broker/limited_log.h"
#include "server/broker/probe.h"
#include "server/broker/rereading.h"
#include "server/broker/stray_prefixes.h"
#include "server/broker/stream_wakes.h"
#include "server/broker/subscriber.h"
#include "server/broker/twin_streams.h"
#include "server/fleet/fleet.h"
#include "server/limits/recent_times.h"
#include "server/log/logger.h"
#include "server/mqtt/settings.h"
#include "server/mqtt/unacked.h"
#include "server/robot/connection_reports.h"

namespace uplink::broker {

/// Reads a fleet's broker by three connections: for durable messages, for live ones, and for media.
/// It reads while this process has the lease of the topics; meanwhile it holds their twins' robots.
///
/// Thread:  constructed and destroyed by main while its thread does not run. The functions under
///          "Any thread" from any; the rest on its thread, which is that of its links.
class Broker final : private SubscriberEvents {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    log::Logger& logger;
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    /// Counts what becomes of the messages: the page of model::MessageSource::kCyberwave.
    metrics::Ledger& ledger;
    cyberwave::Twins& twins;
    /// In the order of cyberwave::Connection; without media unless they are counted.
    std::vector<mqtt::ClientSettings> clients;
    cyberwave::JudgeTerms terms;
    std::string fleet_name;
    std::size_t payload_bytes_max = 0;
    /// Whether the journals are more than half full.
    std::function<bool()> journal_over_half;
    mqtt::MakeLink make_link;
    /// Runs a job on the broker's thread, after all jobs that were posted before. Any thread.
    std::function<void(std::function<void()>)> post;
    std::function<std::uint64_t()> random;
    /// How much one robot may store, as of the last reload.
    const ingest::Allowances& allowances;
    /// Where the twins' connections are reported; null: nowhere.
    robot::ConnectionReports* reports = nullptr;
  };
  explicit Broker(Context context);
  ~Broker() override = default;
  Broker(const Broker&) = delete;
  Broker& operator=(const Broker&) = delete;

  /// Called before everything else.
  void SetLease(LeaseView& lease) { lease_ = &lease; }

  /// This process has taken the lease.
  void Begin(Grant grant);
  /// The store may lack records that it confirmed, or may have records that it never confirmed. The
  /// broker delivers unacked messages again, once the store has said what it has.
  void Reread();
  /// Goes on with what the store has, as LeaseView::RereadSoon requested.
  void Resume(Remembered remembered);
  /// This process has lost the lease.
  void End();
  /// Stops reading, so that waiting messages can settle.
  void BeginDrain();
  /// Its thread calls it each second.
  void Tick();

  // --- Any thread ---

  /// Whether we learn what twins say.
  [[nodiscard]] fleet::Fleet::HearingState hearing() const { return health_.hearing(); }
  [[nodiscard]] bool lease_failing() const { return lease_ != nullptr && lease_->failing(); }
  [[nodiscard]] bool holds_lease() const { return probe_.lease_held.value() != 0; }
  /// Messages whose records wait for their commit.
  [[nodiscard]] std::size_t waiting() const {
    return static_cast<std::size_t>(
        std::max<std::int64_t>(context_.ledger.Read().messages.in_flight, 0));
  }
  /// Waits until nothing waits for its commit, or until `deadline`.
  void WaitSettled(SteadyTime deadline) {
    std::unique_lock lock(mutex_);
    settled_.wait_until(lock, deadline, [this] { return waiting() == 0; });
  }
  [[nodiscard]] const metrics::Ledger& ledger() const { return context_.ledger; }
  [[nodiscard]] const BrokerProbe& probe() const { return probe_; }
  [[nodiscard]] const cyberwave::Twins& twins() const { return context_.twins; }
  [[nodiscard]] std::size_t unacked_max() const { return context_.clients.front().unacked_max; }
  /// Of the connections that exist, in the order of cyberwave::Connection.
  [[nodiscard]] std::vector<ConnectionStatus> connections() const { return statuses_.Read(); }
  [[nodiscard]] const mqtt::ClientProbe& client_probe(Connection connection) const {
    return subscribers_[static_cast<std::size_t>(connection)].probe();
  }
  [[nodiscard]] std::optional<SystemTime> subscribed_since() const {
    return health_.subscribed_since();
  }
  /// When we last found that the broker had lost our session.
  [[nodiscard]] std::optional<SystemTime> session_lost_at() const {
    return connection_log_.session_lost_at();
  }
  [[nodiscard]] std::string held_by() const { return lease_ == nullptr ? "" : lease_->held_by(); }

 private:
  /// The wake number for room in the journal; streams are numbered from 1.
  static constexpr std::uint64_t kRoom = 0;

  void OnConnected(Connection connection, const mqtt::Connected& connected) override;
  void OnSubscribed(Connection connection) override;
  void OnMessage(Connection connection, const mqtt::Message& message) override;
  void OnTrouble(Connection connection, const mqtt::Trouble& trouble) override;
  void OnEnded(Connection connection, const mqtt::End& end) override;

  void OnWakes();
  /// A journal has committed, for which acks waited (AcksAfterCommit).
  void OnCommitted(std::size_t shard) {
    commits_.OnCommitted(shard);
    AfterWork();
  }
  void Start(Connection connection, bool expect_session);
  /// Unsubscribes what the kept session subscribed to under that topic's prefix.
  void UnsubscribeStray(std::string_view topic);
  void StopClient(Connection connection);
  [[nodiscard]] Subscriber& Of(Connection connection) {
    return subscribers_[static_cast<std::size_t>(connection)];
  }
  [[nodiscard]] bool Has(Connection connection) const {
    return static_cast<std::size_t>(connection) < context_.clients.size();
  }
  void OnLive(Connection connection, const mqtt::Message& message,
              const cyberwave::Arrival& arrived);
  void DropHeldBack();
  void TryHeldBack();
  void AfterWork();
  /// Tells the store which remembered deliveries have expired.
  void StoreExpired();
  void UpdateHealth();
  /// Updates connections().
  void NoteStatuses();

  const Context context_;
  LeaseView* lease_ = nullptr;
  BrokerProbe probe_;
  ConnectionLog connection_log_;
  log::RateLimited refused_log_;
  LimitedLog limited_log_;
  BrokerHealth health_;
  ConnectionStatuses statuses_;
  StreamWakes wakes_;
  mqtt::ConnectionNumbers numbers_;
  std::array<Subscriber, kConnectionNames.size()> subscribers_;
  TwinStreams streams_;
  Commits commits_;
  Intake intake_;
  StrayPrefixes strays_;
  std::optional<HeldBackMessage> held_;
  bool began_ = false;
  bool draining_ = false;
  /// The durable connection waits for what the store remembers.
  Rereading rereading_;
  /// When a connection last ended. The lease is checked after that before the next connection.
  SteadyTime ask_since_{};
  limits::RecentTimes<1> twin_looks_;
  std::uint64_t fleet_changes_ = 0;

  std::mutex mutex_;
  std::condition_variable settled_;
};

}  // namespace uplink::broker
