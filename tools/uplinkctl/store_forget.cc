#include "tools/uplinkctl/store_forget.h"

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include <absl/status/statusor.h>
#include <fmt/core.h>

#include "server/store/lease_judge.h"
#include "storage/forget_store.h"
#include "storage/leases.h"
#include "storage/postgres/forget_store.h"
#include "storage/postgres/leases.h"
#include "storage/sqlite/file_lock.h"
#include "storage/sqlite/forget_store.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/question.h"
#include "tools/uplinkctl/store_target.h"

namespace uplink::ctl {
namespace {

using storage::ForgetAnswer;

/// How long a server may take to let go of a robot: it looks twice a second, and with --end-stream
/// what waits is committed first.
constexpr std::chrono::seconds kAnswerWait{20};
constexpr milliseconds kLookEvery{100};
constexpr std::string_view kRuriPrefix = "rcan://";

/// A store, and what else is known of who serves it.
struct Target {
  /// Of an SQLite file that no server has: none starts meanwhile. Goes last.
  std::unique_ptr<storage::sqlite::FileLock> lock;
  std::unique_ptr<storage::ForgetStore> store;
  /// Of a database that servers share.
  std::unique_ptr<storage::Leases> leases;
};

absl::StatusOr<Target> OpenSqlite(const std::string& path) {
  Target target;
  auto store = storage::sqlite::SqliteForgetStore::Open(path);
  if (!store.ok()) return store.status();
  target.store = *std::move(store);
  auto lock = storage::sqlite::FileLock::Take(path);
  if (lock.ok()) {
    target.lock = *std::move(lock);
  } else if (!storage::sqlite::IsInUse(lock.status())) {
    return lock.status();
  }
  return target;
}

absl::StatusOr<Target> OpenPostgres(const storage::postgres::StoreOptions& options,
                                    const Clock& clock) {
  Target target;
  auto store = storage::postgres::PostgresForgetStore::Make(options, clock);
  if (!store.ok()) return store.status();
  target.store = *std::move(store);
  auto leases = storage::postgres::PostgresLeases::Make(options, clock);
  if (!leases.ok()) return leases.status();
  target.leases = *std::move(leases);
  return target;
}

absl::StatusOr<Target> Open(const StoreForgetRequest& request, const Clock& clock) {
  const auto target = TargetOf(request.url, request.password_file);
  if (!target.ok()) return target.status();
  if (const auto* path = std::get_if<std::string>(&*target)) return OpenSqlite(*path);
  return OpenPostgres(std::get<storage::postgres::StoreOptions>(*target), clock);
}

/// The server that is to let go of the robot; nothing if none is there.
absl::StatusOr<std::optional<std::string>> ServerOf(Target& target,
                                                    const std::optional<storage::RobotHold>& hold) {
  if (target.lock != nullptr || !hold) return std::nullopt;
  if (target.leases == nullptr) return std::optional<std::string>("the server that has the file");
  const auto leases = target.leases->Read();
  if (!leases.ok()) return leases.status();
  for (const storage::Lease& lease : *leases) {
    if (lease.process != hold->owner || lease.released) continue;
    if (lease.renewed_ago <= store::kSilentMax) return std::optional(lease.card.name);
  }
  return std::nullopt;
}

void Show(const StoreForgetRequest& request, const std::optional<std::string>& server,
          const std::vector<storage::TableCount>& counts) {
  fmt::print("robot           {}\n", request.ruri);
  fmt::print("held by         {}\n", server.value_or("no server"));
  fmt::print("will go\n");
  for (const storage::TableCount& count : counts) {
    fmt::print("  {:<24}{:>10}\n", count.table, count.rows);
  }
}

/// A robot as the store has it.
struct Found {
  std::string ruri;
  std::optional<storage::RobotHold> hold;
  /// Has it in memory.
  std::optional<std::string> server;
};

/// Why the robot stays.
absl::Status Refused(const storage::AnsweredForget& answer, const std::string& server) {
  switch (answer.answer) {
    case ForgetAnswer::kLetGo:
      return absl::OkStatus();
    case ForgetAnswer::kHasStream:
      return absl::FailedPreconditionError(
          "the robot has a stream; --end-stream ends it, and the robot may come back");
    case ForgetAnswer::kRecordsWait:
      return absl::FailedPreconditionError(
          "records of the robot wait for the store; try again, or wait for them by --end-stream");
    case ForgetAnswer::kNone:
      break;
  }
  return absl::UnavailableError(
      fmt::format("{} did not let go of the robot within {} s", server, kAnswerWait.count()));
}

/// The epoch that the robot had when its server let go of it.
absl::StatusOr<storage::Epoch> Await(storage::ForgetRequests& requests, std::uint64_t number,
                                     const std::string& server, const Clock& clock) {
  const SteadyTime until = clock.Steady() + kAnswerWait;
  while (true) {
    const auto answer = requests.AnswerTo(number);
    if (!answer.ok()) return answer.status();
    const bool late = clock.Steady() >= until;
    if (answer->answer != ForgetAnswer::kNone || late) {
      if (absl::Status refused = Refused(*answer, server); !refused.ok()) return refused;
      return answer->epoch;
    }
    std::this_thread::sleep_for(kLookEvery);
  }
}

/// Deletes what the robot is and has, once its server let go of it. Returns the bound of its
/// histories.
absl::StatusOr<storage::EntryBound> RemoveNow(Target& target, const Found& found,
                                              std::uint64_t number, const Clock& clock) {
  storage::Epoch epoch = found.hold ? found.hold->epoch : 0;
  if (found.server) {
    const auto let_go = Await(target.store->requests(), number, *found.server, clock);
    if (!let_go.ok()) return let_go.status();
    epoch = *let_go;
  }
  const auto removed = target.store->removal().Remove(found.ruri, epoch);
  if (!removed.ok()) return removed.status();
  if (!removed->has_value()) {
    return absl::AbortedError("the robot spoke meanwhile, and stays; try again");
  }
  return **removed;
}

absl::Status RemoveHistories(storage::RobotRemoval& removal, const std::string& ruri,
                             storage::EntryBound below) {
  while (true) {
    const auto some = removal.RemoveHistories(ruri, below);
    if (!some.ok()) return some.status();
    if (*some == 0) return absl::OkStatus();
  }
}

absl::Status Forget(Target& target, const Found& found, bool end_stream, const Clock& clock) {
  storage::ForgetRequests& requests = target.store->requests();
  const auto number = requests.Ask(found.ruri, end_stream);
  if (!number.ok()) return number.status();
  const auto removed = RemoveNow(target, found, *number, clock);
  // Either way: the others follow, or nobody answers any more.
  absl::Status finished = requests.Finish(*number);
  if (!removed.ok()) return removed.status();
  if (!finished.ok()) return finished;
  return RemoveHistories(target.store->removal(), found.ruri, *removed);
}

}  // namespace

int StoreForget(const StoreForgetRequest& request) {
  // The store has rows of the servers' own beside those of robots.
  if (!request.ruri.starts_with(kRuriPrefix)) {
    return ExitOf(absl::InvalidArgumentError(
        fmt::format("{} is no RURI: a robot's begins with {}", request.ruri, kRuriPrefix)));
  }
  const SystemClock clock;
  absl::StatusOr<Target> target = Open(request, clock);
  if (!target.ok()) return ExitOf(target.status());
  const auto counts = target->store->removal().Count(request.ruri);
  if (!counts.ok()) return ExitOf(counts.status());
  if (counts->empty()) {
    fmt::print(stderr, "uplinkctl: the store has nothing of {}\n", request.ruri);
    return kExitFailed;
  }
  const auto hold = target->store->removal().HoldOf(request.ruri);
  if (!hold.ok()) return ExitOf(hold.status());
  const auto server = ServerOf(*target, *hold);
  if (!server.ok()) return ExitOf(server.status());
  Show(request, *server, *counts);
  if (!request.yes && !SaysYes("Forget the robot, and delete all of this for good?")) {
    fmt::print("nothing was deleted\n");
    return kExitFailed;
  }
  const absl::Status forgotten =
      Forget(*target, {request.ruri, *hold, *server}, request.end_stream, clock);
  if (!forgotten.ok()) return ExitOf(forgotten);
  fmt::print("forgotten\n");
  return kExitDone;
}

}  // namespace uplink::ctl
