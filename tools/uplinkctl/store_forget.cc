#include "tools/uplinkctl/store_forget.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include <absl/status/statusor.h>
#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "schema/model/ids.h"
#include "server/admin/actions.h"
#include "server/store/lease_judge.h"
#include "storage/forget_store.h"
#include "storage/leases.h"
#include "storage/postgres/parts.h"
#include "storage/sqlite/file_lock.h"
#include "storage/sqlite/parts.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/store_access.h"
#include "tools/uplinkctl/store_comeback.h"
#include "tools/uplinkctl/store_target.h"

namespace uplink::ctl {
namespace {

using storage::ForgetAnswer;

/// How long a server may take to let go of a robot: it looks twice a second, and with --end-stream
/// what waits is committed first.
constexpr std::chrono::seconds kAnswerWait{20};
constexpr milliseconds kLookEvery{100};
/// How often a robot is asked for that comes back at once.
constexpr int kTriesMax = 10;
constexpr std::string_view kRuriPrefix = "rcan://";
/// Of names that are shown.
constexpr std::size_t kNameBytesMax = 512;

/// A store, and what else is known of who serves it.
struct Target {
  /// Of an SQLite file; else empty.
  std::string path;
  /// Of an SQLite file that no server has: none starts meanwhile. Goes last.
  std::unique_ptr<storage::sqlite::FileLock> lock;
  std::unique_ptr<storage::ForgetStore> store;
  /// Of a database that servers share.
  std::unique_ptr<storage::Leases> leases;
};

/// Locks an SQLite file that is there and that no server has.
absl::Status Lock(Target& target) {
  // Opening the file reports one that is missing or cannot be read.
  std::error_code error;
  if (!std::filesystem::exists(target.path, error)) return absl::OkStatus();
  auto lock = storage::sqlite::FileLock::Take(target.path);
  if (lock.ok()) {
    target.lock = *std::move(lock);
  } else if (!storage::sqlite::IsInUse(lock.status())) {
    return lock.status();
  }
  return absl::OkStatus();
}

absl::StatusOr<Target> OpenSqlite(const std::string& path) {
  Target target;
  target.path = path;
  // Before the database is opened, and it goes after it: closing the lock's descriptor drops the
  // locks that SQLite has on the file.
  if (absl::Status locked = Lock(target); !locked.ok()) return locked;
  auto store = storage::sqlite::OpenForgetStore(path);
  if (!store.ok()) return store.status();
  target.store = *std::move(store);
  return target;
}

absl::StatusOr<Target> OpenPostgres(const storage::postgres::StoreOptions& options,
                                    const Clock& clock) {
  Target target;
  auto store = storage::postgres::MakeForgetStore(options, clock);
  if (!store.ok()) return store.status();
  target.store = *std::move(store);
  auto leases = storage::postgres::MakeLeases(options, clock);
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

/// Which server has the robot in memory, by what the store says.
struct Holder {
  enum class State : std::uint8_t {
    /// No server, or one that was silent for longer than kLeaseKept: there is none to ask.
    kNone,
    kThere,
    /// It did not give the robot up, and was not heard for longer than its lease lasts: it may
    /// live, with the robot's stream, cut off from the database alone.
    kSilent,
  };
  State state = State::kNone;
  std::string name;
  std::chrono::seconds heard_ago{0};
};

absl::StatusOr<Holder> HolderOf(Target& target, const std::optional<storage::RobotHold>& hold) {
  if (target.leases == nullptr) {
    if (target.lock != nullptr || !hold) return Holder();
    return Holder{Holder::State::kThere, "the server that has the file"};
  }
  if (!hold) return Holder();
  const auto leases = target.leases->Read();
  if (!leases.ok()) return leases.status();
  for (const storage::Lease& lease : *leases) {
    const bool gone = lease.released || lease.renewed_ago > storage::kLeaseKept;
    if (gone || lease.process != hold->owner) continue;
    const bool silent = lease.renewed_ago > store::kSilentMax;
    return Holder{silent ? Holder::State::kSilent : Holder::State::kThere,
                  PrintableUtf8(lease.card.name, kNameBytesMax), lease.renewed_ago};
  }
  return Holder();
}

std::string TextOf(const Holder& holder) {
  if (holder.state == Holder::State::kNone) return "no server";
  if (holder.state == Holder::State::kThere) return holder.name;
  return fmt::format("{}, not heard for {} s", holder.name, holder.heard_ago.count());
}

void Show(const StoreForgetRequest& request, const Holder& holder,
          const std::vector<storage::TableCount>& counts) {
  fmt::print("robot           {}\n", PrintableUtf8(request.ruri, kNameBytesMax));
  fmt::print("held by         {}\n", TextOf(holder));
  fmt::print("will go\n");
  for (const storage::TableCount& count : counts) {
    fmt::print("  {:<24}{:>10}\n", count.table, count.rows);
  }
}

/// A robot as the store has it.
struct Found {
  std::string ruri;
  std::optional<storage::RobotHold> hold;
  Holder holder;
};

absl::StatusOr<Found> Find(Target& target, const std::string& ruri) {
  const auto hold = target.store->removal().HoldOf(ruri);
  if (!hold.ok()) return hold.status();
  const auto holder = HolderOf(target, *hold);
  if (!holder.ok()) return holder.status();
  return Found{ruri, *hold, *holder};
}

/// Why the robot stays.
absl::Status Refused(const storage::AnsweredForget& answer, const Holder& holder) {
  switch (answer.answer) {
    case ForgetAnswer::kLetGo:
      return absl::OkStatus();
    case ForgetAnswer::kHasStream:
      return absl::FailedPreconditionError(
          "the robot has a stream, or calls; --end-stream ends them, and the robot may come back");
    case ForgetAnswer::kRecordsWait:
      return absl::FailedPreconditionError(
          "records of the robot wait for the store; try again, or wait for them by --end-stream");
    case ForgetAnswer::kNone:
      break;
  }
  return absl::UnavailableError(fmt::format(
      "{} did not let go of the robot within {} s: it is gone or hangs (try again once its lease is"
      " over, after {} s), or records of the robot cannot be committed",
      holder.name, kAnswerWait.count(), store::kSilentMax.count()));
}

absl::Status MayStream(const Holder& holder) {
  return absl::FailedPreconditionError(fmt::format(
      "a server at {} holds the robot, did not stop in order and was not heard for {} s: if it is"
      " gone (killed, or started anew), --end-stream forgets the robot; it may also live with the"
      " robot's stream, cut off from the database",
      holder.name, holder.heard_ago.count()));
}

/// The epoch that the robot had when its server let go of it.
absl::StatusOr<storage::Epoch> Await(storage::ForgetRequests& requests, std::uint64_t number,
                                     const Holder& holder, const Clock& clock) {
  const SteadyTime until = clock.Steady() + kAnswerWait;
  while (true) {
    const auto answer = requests.AnswerTo(number);
    if (!answer.ok()) return answer.status();
    const bool late = clock.Steady() >= until;
    if (answer->answer != ForgetAnswer::kNone || late) {
      if (absl::Status refused = Refused(*answer, holder); !refused.ok()) return refused;
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
  if (found.holder.state == Holder::State::kThere) {
    const auto let_go = Await(target.store->requests(), number, found.holder, clock);
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
  // Either way: the others follow, or no longer answer.
  absl::Status finished = requests.Finish(*number, removed.ok());
  if (!removed.ok()) return removed.status();
  if (!finished.ok()) return finished;
  return RemoveHistories(target.store->removal(), found.ruri, *removed);
}

}  // namespace

int StoreForget(const StoreForgetRequest& request) {
  // The store has rows of the servers' own beside those of robots.
  if (!request.ruri.starts_with(kRuriPrefix) || request.ruri.size() > model::kRuriBytesMax) {
    return ExitOf(absl::InvalidArgumentError(fmt::format(
        "{} is no RURI: a robot's begins with {} and has at most {} bytes",
        PrintableUtf8(request.ruri, kNameBytesMax), kRuriPrefix, model::kRuriBytesMax)));
  }
  const SystemClock clock;
  absl::StatusOr<Target> target = Open(request, clock);
  if (!target.ok()) return ExitOf(target.status());
  const auto counts = target->store->removal().Count(request.ruri);
  if (!counts.ok()) return ExitOf(counts.status());
  if (counts->empty()) {
    fmt::print(stderr, "uplinkctl: the store has nothing of {}; /api/v1/robots lists its robots\n",
               PrintableUtf8(request.ruri, kNameBytesMax));
    return kExitFailed;
  }
  auto found = Find(*target, request.ruri);
  if (!found.ok()) return ExitOf(found.status());
  Show(request, found->holder, *counts);
  // A server can start while the operator thinks about the answer.
  target->store = nullptr;
  target->lock = nullptr;
  if (!request.yes && !SaysYes("Forget the robot, and delete all of this for good?")) {
    fmt::print("nothing was deleted\n");
    return kExitFailed;
  }
  target = Open(request, clock);
  if (!target.ok()) return ExitOf(target.status());
  found = Find(*target, request.ruri);
  if (!found.ok()) return ExitOf(found.status());
  if (found->holder.state == Holder::State::kSilent && !request.end_stream) {
    return ExitOf(MayStream(found->holder));
  }
  absl::Status forgotten = Forget(*target, *found, request.end_stream, clock);
  // A robot whose stream was ended may be back before its rows are gone.
  for (int tries = 1; request.end_stream && absl::IsAborted(forgotten) && tries < kTriesMax;
       ++tries) {
    found = Find(*target, request.ruri);
    if (!found.ok()) return ExitOf(found.status());
    forgotten = Forget(*target, *found, true, clock);
  }
  if (!forgotten.ok()) return ExitOf(forgotten);
  NoteDone(request.url, request.password_file, admin::kRobotForget, request.ruri);
  return ReportRemoved(target->store->removal(), request.ruri, request.end_stream, clock);
}

}  // namespace uplink::ctl
