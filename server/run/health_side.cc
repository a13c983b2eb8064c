#include "server/run/health_side.h"

#include <utility>

#include "server/config/config.h"
#include "server/fleet/liveness.h"
#include "server/health/process.h"
#include "server/run/from_config.h"

namespace uplink::run {
namespace {

health::Monitor::Sources MonitorSources(const HealthSide::Context& context,
                                        const fleet::LiveBudget& live_budget) {
  StoreSide& store = context.store;
  return {
      .clock = context.clock,
      .fleet = context.fleet,
      .journals = store.journals(),
      .journal_probe = store.journal_probe(),
      .sessions = context.relay.session_probe(),
      .journal_limits = store.journal_limits(),
      .certificate_expiry = context.certificate_expiry,
      .store_facts = store.stores().facts,
      .lease_failing = [&store] { return store.lease_probe().failing.value() != 0; },
      .robots_unread = [&store] { return store.robots_unread(); },
      .clock_trust = store.stores().clock.get(),
      .store_space_scarce =
          [&store] { return store.space().view().state != store::SpaceState::kEnough; },
      .forward_incomplete = [&relay = context.relay] { return relay.forwarding().incomplete(); },
      .live_state_over = [&live_budget] { return live_budget.over(); },
      .broker = [&broker = context.broker] { return broker.facts(); },
      .series_left_out = context.series_left_out,
      .http = context.http,
      .identity_unread =
          [&store, &entry = context.fleet.entry()] {
            return store.access_unread() || (entry.only_registered() && store.robots_unread());
          }};
}

}  // namespace

HealthSide::HealthSide(const Context& context)
    : context_(context),
      live_budget_({context.clock, context.fleet, context.broker.twins(), context.logger,
                    LiveBytesMaxOf(context.config.limits, health::MemoryMax())}),
      monitor_(MonitorSources(context, live_budget_)),
      certificate_watch_(monitor_, context.logger),
      presence_watch_({context.clock, context.fleet, monitor_.liveness(), context.logger,
                       sweep_seconds_, context.relay.session_limits().session_idle,
                       [&store = context.store] { return store.leases().OthersUnseen(); },
                       [&broker = context.broker] { return broker.hearing(); }}),
      watchdog_({.alive = [this] { return monitor_.liveness().alive(); }}) {}

void HealthSide::BeginListening() {
  context_.fleet.BeginListening();
  monitor_.liveness().BeginListening();
}

void HealthSide::AddWork(PeriodicWork& work) {
  work.sweep = [this] {
    if (monitor_.draining()) return;  // whom it sends away is not heard, and not offline
    presence_watch_.Sweep();
    live_budget_.Round();
    context_.store.forgetting().Round();
  };
  work.look_at_certificate = [this] {
    const transport::FilesLook look = context_.relay.server().RefreshFiles();
    certificate_watch_.OnLook(look.served, look.status);
  };
  work.ask_relay = [this] {
    presence_watch_.AskRelay([this](auto done) {
      loop::ProbeHandshake(context_.loop, context_.relay.Target(), fleet::kHandshakeWait,
                           std::move(done));
    });
  };
  work.feed_watchdog = [this] { watchdog_.Beat(); };
}

}  // namespace uplink::run
