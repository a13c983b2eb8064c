#include "server/run/page_sources.h"

#include "server/fleet/samples.h"
#include "server/health/process.h"
#include "server/health/samples.h"
#include "server/http/samples.h"
#include "server/journal/samples.h"
#include "server/log/samples.h"
#include "server/rcan/samples.h"
#include "server/rpc/probe.h"
#include "server/run/broker_side.h"
#include "server/run/uncrew_side.h"
#include "server/session/samples.h"
#include "server/store/samples.h"
#include "server/view/samples.h"

namespace uplink::run {

std::vector<metrics::PageSource> PageSourcesOf(const PageParts& parts) {
  return {
      [parts](auto& page) { parts.broker.AddSamples(page); },
      [parts](auto& page) { parts.uncrew.AddSamples(page); },
      [parts](auto& page) { page.AddLedger(parts.ledgers.Sum(model::MessageSource::kUplink)); },
      [parts](auto& page) { page.AddAges(parts.ledgers); },
      [parts](auto& page) { session::AddSamples(parts.sessions, page); },
      [parts](auto& page) { fleet::AddSamples(parts.fleet, page); },
      [parts](auto& page) { fleet::AddSamples(parts.live_budget, page); },
      [parts](auto& page) { health::AddSweepSamples(parts.sweep_seconds, page); },
      [parts](auto& page) {
        journal::AddSamples(parts.journals, parts.journal_limits, parts.clock.Steady(), page);
      },
      [parts](auto& page) { journal::AddSamples(parts.journal_probe, page); },
      [parts](auto& page) { store::AddSamples(parts.stores.facts(), page); },
      [parts](auto& page) { store::AddSamples(parts.space.view(), page); },
      [parts](auto& page) { store::AddSamples(*parts.stores.clock, page); },
      [parts](auto& page) { store::AddSamples(parts.leases, page); },
      [parts](auto& page) { store::AddSamples(parts.access, page); },
      [parts](auto& page) { parts.forwarding.AddSamples(page); },
      [parts](auto& page) { http::AddSamples(parts.http, parts.http_connections_max, page); },
      [parts](auto& page) { rcan::AddSamples(parts.rcan, parts.rcan_series_max, page); },
      [parts](auto& page) { view::AddSamples(parts.watches, page); },
      [parts](auto& page) { health::AddSamples(parts.monitor, page); },
      [parts](auto& page) { log::AddSamples(parts.logger, page); },
      [start = health::ProcessStart{parts.version, parts.clock.System()}](auto& page) {
        health::AddProcessSamples(start, page);
      },
      [parts](auto& page) {
        session::AddSamples(parts.relay, parts.rpc.listener, parts.sessions, page);
      },
      [parts](auto& page) { rpc::AddSamples(parts.rpc, page); },
  };
}

}  // namespace uplink::run
