#include "server/run/view_side.h"

#include "server/run/from_config.h"
#include "server/run/page_sources.h"

namespace uplink::run {
namespace {

view::Queries::Sources QuerySources(const ViewSide::Context& context, view::FaultCounts& faults,
                                    fleet::TopSenders& top) {
  return {.clock = context.clock,
          .fleet = context.fleet,
          .reader = *context.store.stores().reader,
          .journals = context.store.journals(),
          .ledgers = context.ledgers,
          .streams = context.relay.session_probe().streams,
          .version = context.version,
          .to_store_thread = context.early.OnReads(),
          .robots_unread = [&store = context.store] { return store.robots_unread(); },
          .twins = &context.broker.twins(),
          .broker = [&broker = context.broker] { return broker.status(); },
          .drones = &context.uncrew.drones(),
          .faults = &faults,
          .top = &top,
          .settings = &context.settings};
}

std::vector<metrics::PageSource> PageSources(const ViewSide::Context& context,
                                             const view::WatchProbe& watches) {
  StoreSide& store = context.store;
  return PageSourcesOf({.clock = context.clock,
                        .version = context.version,
                        .ledgers = context.ledgers,
                        .sessions = context.relay.session_probe(),
                        .fleet = context.fleet,
                        .live_budget = context.health.live_budget(),
                        .sweep_seconds = context.health.sweep_seconds(),
                        .journals = store.journals(),
                        .journal_limits = store.journal_limits(),
                        .journal_probe = store.journal_probe(),
                        .stores = store.stores(),
                        .space = store.space(),
                        .leases = store.lease_probe(),
                        .access = store.access_probe(),
                        .forwarding = context.relay.forwarding(),
                        .http = context.early.http_probe(),
                        .http_connections_max = HttpConnectionsMaxOf(context.config),
                        .rcan = context.early.rcan_probe(),
                        .rcan_series_max = context.config.rcan.series_max,
                        .watches = watches,
                        .monitor = context.health.monitor(),
                        .relay = context.relay.probe(),
                        .rpc = context.rpc_probe,
                        .broker = context.broker,
                        .uncrew = context.uncrew,
                        .logger = context.logger});
}

}  // namespace

ViewSide::ViewSide(const Context& context)
    : context_(context),
      fault_counts_(context.clock),
      top_(context.clock, context.fleet),
      queries_(QuerySources(context, fault_counts_, top_)),
      watch_interval_(context.config.view.watch_interval),
      watches_({context.clock, context.fleet, queries_, watch_probe_, context.logger}),
      page_sources_(PageSources(context, watch_probe_)),
      robots_scrape_({.clock = context.clock,
                      .fleet = context.fleet,
                      .config = context.config.rcan,
                      .faults = fault_counts_,
                      .probe = context.early.rcan_probe(),
                      .logger = context.logger,
                      .name_key = rcan::NameHash::Draw(context.random),
                      .twins = &context.broker.twins(),
                      .drones = &context.uncrew.drones(),
                      .drones_stale_after = context.config.uncrew.stale_after,
                      .top = &top_}),
      site_({queries_, watches_, context.commands, context.health.monitor(),
             context.early.http_probe(),
             [this](auto format) { return metrics::PageText(page_sources_, format); },
             robots_scrape_, context.logger, context.in_effect}),
      sweeps_("watches", [this](const std::stop_token&) { return Sweep(); }) {}

void ViewSide::EndWatches() {
  sweeps_.Stop();
  watches_.Stop();
}

loop::Next ViewSide::Sweep() {
  watches_.Sweep();
  const SteadyTime::duration interval = watch_interval_.load();
  return {.within = interval, .not_before = interval};
}

void ViewSide::AddWork(PeriodicWork& work) {
  work.look_at_top = [this] { top_.Look(); };
  work.count_faults = [this] {
    robots_scrape_.CountFaultsOn(context_.early.OnReads(), *context_.store.stores().reader);
  };
}

}  // namespace uplink::run
