#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>

#include "metrics/exposition.h"
#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/cyberwave/twins.h"
#include "server/fleet/fleet.h"
#include "server/health/readiness.h"
#include "server/ingest/allowances.h"
#include "server/journal/shards.h"
#include "server/log/logger.h"
#include "server/robot/connection_reports.h"
#include "server/store/lease_rounds.h"
#include "server/view/broker_status.h"
#include "storage/reader.h"
#include "storage/topic_leases.h"

namespace uplink::run {

/// The part of the server that reads a broker: an event loop, the broker's reader, and the rounds
/// that keep the lease of its topics. Without a broker it does nothing.
///
/// Thread: main; what says so from any.
class BrokerSide final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    log::Logger& logger;
    const config::Config& config;
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    metrics::LedgerBook& ledgers;
    /// Of all journals together.
    journal::JournalLimits journal_limits;
    storage::Reader& reader;
    store::LeaseRounds& leases;
    storage::ProcessId process{};
    /// Evenly drawn; seeds the numbers of the broker.
    std::function<std::uint64_t()> random;
    /// What one robot may have stored.
    const ingest::Allowances& allowances;
    robot::ConnectionReports& reports;
  };
  /// `topics` is null if there is no broker.
  BrokerSide(const Context& context, std::unique_ptr<storage::TopicLeases> topics);
  ~BrokerSide();
  BrokerSide(const BrokerSide&) = delete;
  BrokerSide& operator=(const BrokerSide&) = delete;

  void Start();
  /// Nothing more is read from now on.
  void BeginDrain();
  /// Waits a short while for commits, disconnects from the broker and releases the lease of its
  /// topics, so that another server reads on.
  void EndDrain();
  /// Ends its threads. Idempotent.
  void Stop();

  // --- Any thread ---

  /// The server connected to the store anew, and may find that commits are missing.
  void Reread();
  /// Empty without a broker.
  [[nodiscard]] const cyberwave::Twins& twins() const { return twins_; }
  [[nodiscard]] cyberwave::Twins& twins() { return twins_; }
  [[nodiscard]] fleet::Fleet::HearingState hearing() const;
  /// Nothing without a broker.
  [[nodiscard]] std::optional<view::BrokerStatus> status() const;
  [[nodiscard]] health::BrokerFacts facts() const;
  /// None without a broker.
  void AddSamples(metrics::Exposition& page) const;

 private:
  struct Parts;

  const Context context_;
  cyberwave::Twins twins_;
  std::unique_ptr<Parts> parts_;
};

}  // namespace uplink::run
