#include "server/run/store_side.h"

#include <optional>
#include <utility>

#include "server/config/config.h"
#include "server/run/from_config.h"

namespace uplink::run {

StoreSide::StoreSide(const Context& context, store::Stores stores)
    : context_(context),
      journal_limits_(JournalLimitsOf(context.config.journal)),
      stores_(std::move(stores)),
      writers_(stores_.writers, WritersContext()),
      forgetting_({context.fleet, context.clock, context.logger, context.config.fleet.forget_after,
                   [this] { return stores_.clock->vouched(); },
                   [this](robot::Robot& robot) {
                     journals_.Leave({&robot, robot.id()});
                   }}),
      robot_load_rounds_(
          {context.fleet, journals_, *stores_.reader, context.logger,
           context.config.limits.robots_max, store::AdoptGraceOf(stores_, context.config.presence),
           [this](SystemTime heard_at) { return forgetting_.IsForgotten(heard_at); }}),
      leases_(std::move(stores_.leases),
              {context.fleet, journals_, context.clock, context.logger, lease_probe_,
               context.process, context.config.presence, store::IsGone,
               [this](SystemTime heard_at) { return forgetting_.IsForgotten(heard_at); },
               context.shut_out}),
      forget_rounds_({context.fleet, journals_, context.clock, context.logger, *stores_.forget,
                      context.process, !config::IsPostgres(context.config.store),
                      store::RowsRuleOf(context.config), *stores_.clock}),
      clock_rounds_({context.clock, *stores_.marks, *stores_.clock, context.logger,
                     context.kernel_clock_synchronised}),
      space_rounds_({context.fleet, context.clock, context.logger, stores_.space,
                     context.config.store.free_min}),
      health_log_({.facts = stores_.facts,
                   .retention = [this] { return journals_.retain_error(); },
                   .checkpoints = [this] { return journals_.checkpoint_error(); },
                   .store = [this] { return journals_.last_error(); },
                   .went_back = [this] { return journals_.TakeWentBack(); }},
                  context.logger) {
  leases_.SetPort(context.config.listen.relay.port);
  if (stores_.access == nullptr) return;
  access_.emplace(store::AccessRounds::Context{.store = *stores_.access,
                                               .denied = context.denied,
                                               .settings = context.settings,
                                               .clock = context.clock,
                                               .logger = context.logger,
                                               .probe = access_probe_,
                                               .store_name = store::NameOf(context.config.store),
                                               .saved_path = config::SavedListPath(context.config),
                                               .denied_changed = context.denied_changed,
                                               .file_lists = context.file_lists,
                                               .signal = stores_.access_signal.get()});
}

store::Writers::Context StoreSide::WritersContext() {
  return {.clock = context_.clock,
          .ledgers = context_.ledgers,
          .probe = journal_probe_,
          .fleet = context_.fleet,
          .process = context_.process,
          .random = context_.random,
          .limits = journal_limits_,
          .spatial_committed = context_.spatial_committed,
          .store_reconnected = context_.reconnected,
          .checkpoint_every = context_.config.store.checkpoint,
          .is_over = [this](const storage::ProcessId& process) -> std::optional<bool> {
            const auto verdict = leases_.VerdictOf(process);
            if (!verdict) return std::nullopt;
            return verdict->over != store::Over::kNo;
          },
          .logger = &context_.logger,
          .moved = context_.moved};
}

void StoreSide::ReadRobots() {
  context_.fleet.OnPresence(
      [this](const storage::RobotRef& robot, const storage::StoredPresence& now, auto why) {
        journals_.NotePresence(robot, now.presence, now.since, why, now.parked_until);
      });
  health_log_.LookAtFacts();
  if (access_) access_->Begin(stores_.away);
  if (stores_.away.ok()) clock_rounds_.Round();
  robot_load_rounds_.Begin(stores_.away);
  if (stores_.away.ok()) leases_.Round();
}

void StoreSide::StartRounds(std::uint16_t port) {
  leases_.SetPort(port);
  leases_.Start();
  forget_rounds_.Start();
  if (access_) access_->Start();
}

void StoreSide::Stop() {
  leases_.Stop();
  forget_rounds_.Stop();
  if (access_) access_->Stop();
  writers_.Stop();
}

void StoreSide::AddWork(const loop::Post& reads, PeriodicWork& work) {
  work.look_at_store = [this] { health_log_.Look(); };
  work.read_robots = [this, reads] { robot_load_rounds_.ReadOn(reads); };
  work.ask_for_snapshot = [this, reads] { stores_.snapshot->AskOn(reads); };
  work.look_at_space = [this, reads] { space_rounds_.LookOn(reads); };
  work.look_at_clock = [this, reads] { clock_rounds_.LookOn(reads); };
}

}  // namespace uplink::run
