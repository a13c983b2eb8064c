#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/admin/audit_trail.h"
#include "server/admin/commands.h"
#include "server/admin/shared_store.h"
#include "server/fleet/fleet.h"
#include "server/journal/events.h"
#include "server/loop/event_loop.h"
#include "server/loop/one_at_a_time.h"
#include "server/run/periodic.h"
#include "server/store/open.h"

namespace uplink::run {

/// How long a command waits for the configuration to be read again.
inline constexpr std::chrono::seconds kReloadWait{5};

/// What operators decide, and the audit of that and of what the server does.
///
/// Thread: main; commands() any.
class CommandSide final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    admin::AuditTrail& audit;
    fleet::Fleet& fleet;
    store::Stores& stores;
    loop::EventLoop& loop;
    /// Reads the configuration again. On the loop's thread.
    std::function<admin::Reloaded()> reload;
    /// What operators decide has changed: servers look at it each second anyway. Any thread.
    std::function<void()> changed{};
  };
  explicit CommandSide(const Context& context);
  CommandSide(const CommandSide&) = delete;
  CommandSide& operator=(const CommandSide&) = delete;

  [[nodiscard]] admin::Commands& commands() { return commands_; }

  /// The server, by its name, has started.
  void NoteStart(std::string name, std::string_view version);
  void NoteStop();
  /// A certificate moved a robot to another fleet. Any thread.
  void NoteMove(const journal::Moved& moved);
  /// What a signal or a changed file brought. On the loop's thread.
  void NoteReload(const admin::Reloaded& reloaded, std::string_view by);
  /// Writes what waits of the audit. Waits for the store.
  void Flush() { context_.audit.Flush(store_); }
  /// What is due again and again; what waits for the store goes to `reads`.
  void AddWork(const loop::Post& reads, PeriodicWork& work);

 private:
  [[nodiscard]] std::optional<std::string> FleetOf(std::string_view ruri) const;
  /// The robot calls here, and has no stream here.
  [[nodiscard]] bool OnlyCalls(std::string_view ruri) const;
  [[nodiscard]] absl::StatusOr<admin::Reloaded> Reload() const;
  void Note(std::string_view action, std::string detail);

  const Context context_;
  admin::SharedStore store_;
  admin::Commands commands_;
  loop::OneAtATime flush_;
  /// Of the server, since its start.
  std::string name_;
};

}  // namespace uplink::run
