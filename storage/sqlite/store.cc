#include "storage/sqlite/store.h"

#include <string>
#include <utility>

#include "storage/bounds.h"
#include "storage/retention.h"
#include "storage/shared_items.h"
#include "storage/sqlite/batch_commit.h"
#include "storage/sqlite/claims.h"
#include "storage/sqlite/connections.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/file_lock.h"
#include "storage/sqlite/open_stream.h"
#include "storage/sqlite/store_files.h"
#include "storage/sqlite/tables.h"

namespace uplink::storage::sqlite {
namespace {

/// One answer per request, in order; the first that fails ends it.
template <typename Result, typename Request, typename Answer>
absl::StatusOr<std::vector<Result>> AnswerEach(std::span<const Request> requests,
                                               const Answer& answer) {
  std::vector<Result> all;
  all.reserve(requests.size());
  for (const Request& request : requests) {
    absl::StatusOr<Result> one = answer(request);
    if (!one.ok()) return one.status();
    all.push_back(*std::move(one));
  }
  return all;
}

}  // namespace

/// Destroyed in reverse: statements, then their database, then the lock.
struct SqliteStore::Impl {
  StoreOptions options;
  std::unique_ptr<FileLock> lock;
  std::unique_ptr<Database> database;
  std::unique_ptr<StoreFiles> files;
  std::unique_ptr<Statement> begin;
  std::unique_ptr<Statement> commit;
  Tables tables;
  /// Since TakeRunsClosed was asked last.
  std::size_t runs_closed = 0;

  /// What is done on the database once it is open.
  absl::Status Prepare();
};

SqliteStore::SqliteStore(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SqliteStore::~SqliteStore() = default;

DamagePtr SqliteStore::damage() const { return impl_->database->damage(); }

absl::StatusOr<std::unique_ptr<SqliteStore>> SqliteStore::Open(const std::string& path,
                                                               const StoreOptions& options) {
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  if (options.exclusive) {
    absl::StatusOr<std::unique_ptr<FileLock>> lock = FileLock::Take(path);
    if (!lock.ok()) return lock.status();
    impl->lock = *std::move(lock);
  }
  auto database = OpenWriter(path, options);
  if (!database.ok()) return database.status();
  impl->database = *std::move(database);
  if (absl::Status prepared = impl->Prepare(); !prepared.ok()) {
    return StatusOfFailedStart(*impl->database, prepared);
  }
  return std::unique_ptr<SqliteStore>(new SqliteStore(std::move(impl)));
}

absl::Status SqliteStore::Impl::Prepare() {
  absl::Status status = tables.Prepare(*database);
  if (!status.ok()) return status;
  auto opened = StoreFiles::Open(*database, options.disk_space);
  if (!opened.ok()) return opened.status();
  files = *std::move(opened);
  const absl::StatusOr<EntryNumber> next_entry = tables.deciding.NextEntry();
  if (!next_entry.ok()) return next_entry.status();
  files->NoteEntry(*next_entry);

  // IMMEDIATE: a transaction that may wait for another writer does so before it has read anything.
  Preparer prepare(*database);
  prepare.Into(begin, "BEGIN IMMEDIATE");
  prepare.Into(commit, "COMMIT");
  return prepare.status();
}

template <typename Work>
auto SqliteStore::InTransaction(const Work& work) -> std::invoke_result_t<Work> {
  // Before, so that nothing is written where no start would find it, nor over a WAL that another
  // program began anew; and after, since that alone says of this commit that a start finds it.
  absl::Status status = impl_->files->Check();
  if (status.ok()) status = impl_->files->CheckRoom();
  if (status.ok()) status = impl_->begin->Run();
  if (!status.ok()) return impl_->files->DamageOr(status);
  auto result = work();
  status = result.status();
  const StoreOptions& options = impl_->options;
  if (status.ok() && options.before_commit) status = options.before_commit();
  if (status.ok()) status = impl_->commit->Run();
  if (!status.ok()) {
    impl_->database->RollbackIfOpen();
    return impl_->files->AfterFailure(std::move(status));
  }
  if (options.after_commit) status = options.after_commit();
  if (status.ok()) status = impl_->files->CheckCommitted();
  if (!status.ok()) return status;
  return result;
}

absl::StatusOr<std::vector<OpenResult>> SqliteStore::OpenStreams(
    std::span<const OpenRequest> requests) {
  auto results = InTransaction([&] {
    return AnswerEach<OpenResult>(requests, [this](const OpenRequest& request) {
      return OpenStream(impl_->tables, request, impl_->options.process);
    });
  });
  if (!absl::IsInvalidArgument(results.status())) return results;
  return absl::InternalError("a stream's row is refused: " +
                             std::string(results.status().message()));
}

absl::StatusOr<std::vector<AdoptResult>> SqliteStore::Adopt(
    std::span<const AdoptRequest> requests) {
  using Results = std::vector<AdoptResult>;
  return InTransaction([&]() -> absl::StatusOr<Results> {
    Results results(requests.size());
    for (std::size_t i = 0; i < requests.size(); ++i) {
      auto adopted = impl_->tables.deciding.AdoptRobot(requests[i], impl_->options.process);
      if (!adopted.ok()) return adopted.status();
      if (!adopted->held_since) continue;
      const auto presence = impl_->tables.deciding.Presence(requests[i].robot->ruri);
      if (!presence.ok()) return presence.status();
      adopted->presence = *presence;
      results[i] = *adopted;
    }
    return results;
  });
}

absl::StatusOr<std::vector<ClaimResult>> SqliteStore::ClaimDrones(
    std::span<const ClaimRequest> requests) {
  return InTransaction([&] {
    return AnswerEach<ClaimResult>(requests, [this](const ClaimRequest& request) {
      return ClaimDrone(impl_->tables, request, impl_->options.process);
    });
  });
}

absl::StatusOr<std::vector<Outcome>> SqliteStore::Commit(const Batch& batch) {
  const auto write = [&](Isolation isolation) {
    const CommitTerms terms{impl_->options.process, impl_->options.rules, *impl_->files};
    BatchCommit commit(*impl_->database, impl_->tables, terms, isolation);
    auto written = InTransaction([&] { return commit.Write(batch); });
    if (!written.ok()) return written;
    impl_->runs_closed += commit.runs_closed();
    impl_->files->NoteEntry(commit.next_entry());
    return written;
  };
  absl::StatusOr<std::vector<Outcome>> outcomes = write(Isolation::kTogether);
  if (!absl::IsInvalidArgument(outcomes.status())) return outcomes;
  outcomes = write(Isolation::kEachAlone);
  if (!absl::IsInvalidArgument(outcomes.status())) return outcomes;
  // What decides (robot, session, gap) was refused, not a record.
  return absl::InternalError("a deciding row is refused: " +
                             std::string(outcomes.status().message()));
}

absl::StatusOr<Swept> SqliteStore::Sweep(SystemTime now) {
  const bool vouches = Vouches(impl_->options.rules.clock, now);
  const std::int64_t until_ms = UnixMs(now - kExpiredKept);
  return InTransaction([&]() -> absl::StatusOr<Swept> {
    Swept swept;
    for (const PresentKind kind : kItemKinds) {
      if (!vouches) break;
      const auto rows = impl_->tables.present_rows(kind).Sweep(until_ms, kSweepRowsMax);
      if (!rows.ok()) return rows.status();
      swept.items += *rows;
    }
    // Changes go by their number, whatever the time is.
    const auto changes = impl_->tables.retention.SweepChanges();
    if (!changes.ok()) return changes.status();
    swept.changes = *changes;
    return swept;
  });
}

absl::StatusOr<std::size_t> SqliteStore::CloseRuns(SystemTime now) {
  if (!Vouches(impl_->options.rules.clock, now)) return 0;
  return InTransaction([&] { return impl_->tables.retention.CloseOld(now - kOpenRunAgeMax, now); });
}

absl::StatusOr<std::vector<ProcessId>> SqliteStore::ProcessesWithOpenConnections() {
  return InTransaction([&] { return impl_->tables.connections.Processes(impl_->options.process); });
}

absl::StatusOr<std::size_t> SqliteStore::EndConnections(const ProcessId& process, SystemTime now) {
  return InTransaction([&] { return impl_->tables.connections.End(process, now); });
}

std::size_t SqliteStore::TakeRunsClosed() { return std::exchange(impl_->runs_closed, 0); }

absl::StatusOr<Trimmed> SqliteStore::TrimQuarantine(std::span<const std::string> ruris) {
  return InTransaction([&] { return impl_->tables.set_aside.TrimQuarantine(ruris); });
}

absl::StatusOr<Erased> SqliteStore::Retain(SystemTime now) {
  const StoreRules& rules = impl_->options.rules;
  if (!Vouches(rules.clock, now)) return Erased();
  return InTransaction([&]() -> absl::StatusOr<Erased> {
    Erased erased;
    absl::Status status;
    if (const auto kept = FirstDayKept(now, rules.retain_history)) {
      status = impl_->tables.retention.EraseHistory(*kept, erased);
    }
    if (const auto kept = FirstDayKept(now, rules.retain_quarantine); kept && status.ok()) {
      status = impl_->tables.retention.EraseSetAside(*kept, erased);
    }
    if (const auto kept = FirstDayKept(now, rules.retain_connections); kept && status.ok()) {
      status = impl_->tables.retention.EraseConnections(*kept, erased);
    }
    if (const auto kept = FirstDayKept(now, rules.retain_audit); kept && status.ok()) {
      status = impl_->tables.retention.EraseAudit(*kept, erased);
    }
    if (!status.ok()) return status;
    return erased;
  });
}

absl::StatusOr<std::vector<std::size_t>> SqliteStore::Checkpoint(std::span<const LiveRow> rows) {
  return InTransaction([&]() -> absl::StatusOr<std::vector<std::size_t>> {
    std::vector<std::size_t> passed_over;
    for (std::size_t place = 0; place < rows.size(); ++place) {
      const auto written = impl_->tables.live.Upsert(rows[place], impl_->options.process);
      if (!written.ok()) return written.status();
      if (!*written) passed_over.push_back(place);
    }
    return passed_over;
  });
}

absl::StatusOr<std::vector<FoundRobot>> SqliteStore::Compare(std::span<const ToldRobot> robots) {
  return InTransaction([&] {
    return AnswerEach<FoundRobot>(robots, [this](const ToldRobot& robot) {
      return impl_->tables.deciding.Compare(robot, impl_->options.process);
    });
  });
}

}  // namespace uplink::storage::sqlite
