#include "server/run/command_side.h"

#include <future>
#include <memory>
#include <utility>

#include <fmt/core.h>

#include "server/admin/actions.h"
#include "server/admin/audit_rows.h"
#include "server/store/process_life.h"

namespace uplink::run {

CommandSide::CommandSide(const Context& context)
    : context_(context),
      store_(*context.stores.access_writes),
      commands_(
          {.clock = context.clock,
           .store = store_,
           .audit = context.audit,
           .rows_of_audit = [&reader = *context.stores.reader](
                                const storage::AuditQuery& query) { return reader.Audit(query); },
           .fleet_of = [this](std::string_view ruri) { return FleetOf(ruri); },
           .only_calls = [this](std::string_view ruri) { return OnlyCalls(ruri); },
           .changed = context.changed,
           .reload = [this] { return Reload(); }}) {}

std::optional<std::string> CommandSide::FleetOf(std::string_view ruri) const {
  const fleet::RobotPtr robot = context_.fleet.Find(ruri);
  if (robot == nullptr) return std::nullopt;
  return robot->id()->fleet;
}

bool CommandSide::OnlyCalls(std::string_view ruri) const {
  const fleet::RobotPtr robot = context_.fleet.Find(ruri);
  return robot != nullptr && robot->calls.open() && !robot->HasStream();
}

absl::StatusOr<admin::Reloaded> CommandSide::Reload() const {
  // The job may run after this has given up.
  const auto done = std::make_shared<std::promise<admin::Reloaded>>();
  std::future<admin::Reloaded> reloaded = done->get_future();
  context_.loop.Post([done, reload = context_.reload] { done->set_value(reload()); });
  if (reloaded.wait_for(kReloadWait) != std::future_status::ready) {
    return absl::UnavailableError("the server is too busy, or stops");
  }
  return reloaded.get();
}

void CommandSide::Note(std::string_view action, std::string detail) {
  context_.audit.Note(admin::RowOfServer(name_, {.action = action, .detail = std::move(detail)},
                                         context_.clock.System()));
}

void CommandSide::NoteStart(std::string name, std::string_view version) {
  name_ = std::move(name);
  Note(admin::kServerStart, std::string(version));
}

void CommandSide::NoteStop() { Note(admin::kServerStop, {}); }

void CommandSide::NoteMove(const journal::Moved& moved) {
  context_.audit.Note(
      admin::RowOfServer(store::HostName(),
                         {.action = admin::kRobotMove,
                          .target = moved.ruri,
                          .fleet = moved.to,
                          .detail = fmt::format("{} {} {}", moved.from, moved.to, moved.gateway)},
                         context_.clock.System()));
}

void CommandSide::NoteReload(const admin::Reloaded& reloaded, std::string_view by) {
  storage::AuditRow row = admin::RowOfServer(
      name_, {.action = admin::kReload, .target = std::string(by), .detail = DetailOf(reloaded)},
      context_.clock.System());
  if (!reloaded.problems.empty()) {
    row.outcome = absl::StatusCodeToString(absl::StatusCode::kFailedPrecondition);
  }
  context_.audit.Note(std::move(row));
}

void CommandSide::AddWork(const loop::Post& reads, PeriodicWork& work) {
  work.write_audit = [this, reads] {
    if (context_.audit.waiting() > 0) flush_.PostBy(reads, [this] { Flush(); });
  };
}

}  // namespace uplink::run
