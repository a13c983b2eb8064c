#include "tools/uplinkctl/store_forget.h"

#include <chrono>
#include <memory>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>
#include <fmt/core.h>

#include "server/config/config.h"
#include "server/store/lease_judge.h"
#include "storage/leases.h"
#include "storage/postgres/leases.h"
#include "storage/postgres/link/url.h"
#include "storage/postgres/robot_removal.h"
#include "storage/robot_removal.h"
#include "storage/sqlite/file_lock.h"
#include "storage/sqlite/robot_removal.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/question.h"

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
  std::unique_ptr<storage::RobotRemoval> removal;
  /// Of a database that servers share.
  std::unique_ptr<storage::Leases> leases;
};

absl::StatusOr<Target> OpenSqlite(const std::string& url) {
  config::StoreConfig store;
  store.url = url;
  const std::string path = config::SqlitePath(store);
  if (path.empty()) {
    return absl::InvalidArgumentError(
        "the store's URL is sqlite:/// and the absolute path of a file, or postgresql://");
  }
  Target target;
  auto removal = storage::sqlite::SqliteRobotRemoval::Open(path);
  if (!removal.ok()) return removal.status();
  target.removal = *std::move(removal);
  auto lock = storage::sqlite::FileLock::Take(path);
  if (lock.ok()) {
    target.lock = *std::move(lock);
  } else if (!storage::sqlite::IsInUse(lock.status())) {
    return lock.status();
  }
  return target;
}

absl::StatusOr<Target> Open(const StoreForgetRequest& request, const Clock& clock) {
  if (!storage::postgres::IsPostgresUrl(request.url)) return OpenSqlite(request.url);
  storage::postgres::StoreOptions options;
  options.url = request.url;
  options.password_file = request.password_file;
  // No message is acked here.
  options.accept_unsafe = true;
  Target target;
  auto removal = storage::postgres::PostgresRobotRemoval::Make(options, clock);
  if (!removal.ok()) return removal.status();
  target.removal = *std::move(removal);
  auto leases = storage::postgres::PostgresLeases::Make(options, clock);
  if (!leases.ok()) return leases.status();
  target.leases = *std::move(leases);
  return target;
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
absl::StatusOr<storage::Epoch> Await(storage::RobotRemoval& removal, std::uint64_t number,
                                     const std::string& server) {
  const auto until = std::chrono::steady_clock::now() + kAnswerWait;
  while (true) {
    const auto answer = removal.AnswerTo(number);
    if (!answer.ok()) return answer.status();
    const bool late = std::chrono::steady_clock::now() >= until;
    if (answer->answer != ForgetAnswer::kNone || late) {
      if (absl::Status refused = Refused(*answer, server); !refused.ok()) return refused;
      return answer->epoch;
    }
    std::this_thread::sleep_for(kLookEvery);
  }
}

/// Deletes what the robot is and has, once its server let go of it.
absl::Status RemoveNow(Target& target, const StoreForgetRequest& request,
                       const std::optional<storage::RobotHold>& hold,
                       const std::optional<std::string>& server, std::uint64_t number) {
  storage::Epoch epoch = hold ? hold->epoch : 0;
  if (server) {
    const auto let_go = Await(*target.removal, number, *server);
    if (!let_go.ok()) return let_go.status();
    epoch = *let_go;
  }
  const auto removed = target.removal->Remove(request.ruri, epoch);
  if (!removed.ok()) return removed.status();
  if (!*removed) {
    return absl::AbortedError("the robot spoke meanwhile, and stays; try again");
  }
  return absl::OkStatus();
}

absl::Status RemoveHistories(Target& target, const std::string& ruri) {
  while (true) {
    const auto some = target.removal->RemoveHistories(ruri);
    if (!some.ok()) return some.status();
    if (*some == 0) return absl::OkStatus();
  }
}

absl::Status Forget(Target& target, const StoreForgetRequest& request,
                    const std::optional<storage::RobotHold>& hold,
                    const std::optional<std::string>& server) {
  const auto number = target.removal->Ask(request.ruri, request.end_stream);
  if (!number.ok()) return number.status();
  absl::Status removed = RemoveNow(target, request, hold, server, *number);
  // Either way: the others follow, or nobody answers any more.
  absl::Status finished = target.removal->Finish(*number);
  if (!removed.ok()) return removed;
  if (!finished.ok()) return finished;
  return RemoveHistories(target, request.ruri);
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
  const auto counts = target->removal->Count(request.ruri);
  if (!counts.ok()) return ExitOf(counts.status());
  if (counts->empty()) {
    fmt::print(stderr, "uplinkctl: the store has nothing of {}\n", request.ruri);
    return kExitFailed;
  }
  const auto hold = target->removal->HoldOf(request.ruri);
  if (!hold.ok()) return ExitOf(hold.status());
  const auto server = ServerOf(*target, *hold);
  if (!server.ok()) return ExitOf(server.status());
  Show(request, *server, *counts);
  if (!request.yes && !SaysYes("Forget the robot, and delete all of this for good?")) {
    fmt::print("nothing was deleted\n");
    return kExitFailed;
  }
  const absl::Status forgotten = Forget(*target, request, *hold, *server);
  if (!forgotten.ok()) return ExitOf(forgotten);
  fmt::print("forgotten\n");
  return kExitDone;
}

}  // namespace uplink::ctl
