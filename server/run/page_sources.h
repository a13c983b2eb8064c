#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "metrics/cells.h"
#include "metrics/exposition.h"
#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/fleet/live_budget.h"
#include "server/forward/forwarding.h"
#include "server/health/monitor.h"
#include "server/http/limits.h"
#include "server/http/probe.h"
#include "server/journal/probe.h"
#include "server/journal/shards.h"
#include "server/log/logger.h"
#include "server/rcan/probe.h"
#include "server/rpc/probe.h"
#include "server/session/probe.h"
#include "server/store/access_probe.h"
#include "server/store/lease_probe.h"
#include "server/store/open.h"
#include "server/store/space_rounds.h"
#include "server/transport/probe.h"
#include "server/view/watch_probe.h"

namespace uplink::run {

class BrokerSide;
class UncrewSide;

/// Where the samples of /metrics come from. All of it outlives the page.
struct PageParts {
  const Clock& clock;
  const std::string& version;
  const metrics::LedgerBook& ledgers;
  const session::SessionProbe& sessions;
  const fleet::Fleet& fleet;
  const fleet::LiveBudget& live_budget;
  const metrics::LatencyDistribution& sweep_seconds;
  const journal::Shards& journals;
  journal::JournalLimits journal_limits;
  const journal::JournalProbe& journal_probe;
  const store::Stores& stores;
  const store::SpaceRounds& space;
  const store::LeaseProbe& leases;
  const store::AccessProbe& access;
  const forward::Forwarding& forwarding;
  const http::HttpProbe& http;
  http::ConnectionsMax http_connections_max{};
  const rcan::RcanProbe& rcan;
  std::size_t rcan_series_max = 0;
  const view::WatchProbe& watches;
  health::Monitor& monitor;
  const transport::RelayProbe& relay;
  const rpc::RpcProbe& rpc;
  const BrokerSide& broker;
  const UncrewSide& uncrew;
  const log::Logger& logger;
};

/// Every metric of the catalogue. Each ledger is summed once for a text, so that received = settled
/// + in flight holds in it.
[[nodiscard]] std::vector<metrics::PageSource> PageSourcesOf(const PageParts& parts);

}  // namespace uplink::run
