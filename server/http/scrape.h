#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "metrics/exposition.h"
#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/health/monitor.h"
#include "server/http/probe.h"
#include "server/journal/shards.h"
#include "server/rcan/scrape.h"
#include "server/session/probe.h"
#include "storage/store.h"

namespace uplink::http {

/// What /metrics answers: every metric of the catalogue, read from the components. The ledgers are
/// summed once, so that received = settled + in flight holds in each text. Thread-safe.
class Scrape final {
 public:
  struct Sources {
    const Clock& clock;
    const fleet::Fleet& fleet;
    const journal::Shards& journals;
    const journal::JournalProbe& journal_probe;
    const session::SessionProbe& sessions;
    const metrics::LedgerBook& ledgers;
    health::Monitor& monitor;
    const HttpProbe& http;
    journal::JournalLimits journal_limits;
    std::size_t http_connections_max = 0;
    const rcan::RcanProbe& rcan;
    const metrics::LatencyDistribution& sweep_seconds;
    std::size_t rcan_series_max = 0;
    std::string version;
    std::function<storage::StoreFacts()> store_facts = [] { return storage::StoreFacts(); };
    /// Adds the samples of the robots' transport, which this folder does not know.
    std::function<void(metrics::Exposition&)> add_relay;
  };
  explicit Scrape(Sources sources);

  [[nodiscard]] std::string Text(metrics::Format format = metrics::Format::kText) const;

 private:
  void AddSessions(metrics::Exposition& page) const;
  void AddFleet(metrics::Exposition& page) const;
  void AddJournal(metrics::Exposition& page) const;
  void AddRcan(metrics::Exposition& page) const;
  void AddHttp(metrics::Exposition& page) const;
  void AddProcess(metrics::Exposition& page) const;

  const Sources sources_;
  const SystemTime started_at_;
};

}  // namespace uplink::http
