#include "storage/postgres/store.h"

#include <atomic>
#include <string>
#include <utility>

#include "storage/postgres/link/link.h"
#include "storage/postgres/link_options.h"
#include "storage/postgres/live_rows.h"
#include "storage/postgres/write/batch_commit.h"
#include "storage/postgres/write/claims.h"
#include "storage/postgres/write/holds.h"
#include "storage/postgres/write/open_streams.h"
#include "storage/postgres/write/retain.h"
#include "storage/postgres/write/robot_connections.h"
#include "storage/postgres/write/transaction.h"
#include "storage/postgres/write/upkeep.h"

namespace uplink::storage::postgres {
namespace {

/// How often a transaction is run that others stood in the way of, before the journal is told.
constexpr int kTriesMax = 4;

}  // namespace

bool IsWorthRetry(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsAborted(status) ||
         absl::IsResourceExhausted(status) || absl::IsDeadlineExceeded(status);
}

struct PostgresStore::Impl {
  StoreOptions options;
  Link link;
  absl::Status open_error;
  // Of the last connection; for other threads.
  std::atomic<bool> unsafe{false};
  std::atomic<std::int64_t> clock_offset_ms{0};
  std::atomic<std::uint64_t> commits_in_doubt{0};
  // By Commit, since TakeRunsClosed was asked last.
  std::size_t runs_closed = 0;
  // The connection that calls may use (Link::connections); 0: none was made yet.
  std::uint64_t trusted = 0;
  QuarantineDays quarantine_days;
  // Calls of WriteLive.
  std::uint64_t checkpoints = 0;

  Impl(StoreOptions given, Link to) : options(std::move(given)), link(std::move(to)) {}

  absl::StatusOr<Connection*> Connected() {
    absl::StatusOr<Connection*> connection = link.Get();
    unsafe.store(link.facts().unsafe);
    clock_offset_ms.store(link.facts().clock_offset.count());
    return connection;
  }
  /// One that has all that was told.
  absl::StatusOr<Connection*> Trusted() {
    absl::StatusOr<Connection*> connection = Connected();
    if (!connection.ok()) return connection;
    // Nothing was told by any before the first.
    if (trusted == 0) trusted = link.connections();
    if (trusted == link.connections()) return connection;
    return absl::UnavailableError("postgresql " + (*connection)->where() +
                                  " was connected to anew: what it has is compared first");
  }
};

PostgresStore::PostgresStore(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PostgresStore::~PostgresStore() = default;

absl::StatusOr<std::unique_ptr<PostgresStore>> PostgresStore::Open(StoreOptions options,
                                                                   const Clock& clock) {
  absl::StatusOr<Link::Options> link = LinkOptionsOf(options);
  if (!link.ok()) return link.status();
  link->migrate = options.migrate;
  const bool connect = options.connect_now;
  auto store = std::unique_ptr<PostgresStore>(
      new PostgresStore(std::make_unique<Impl>(std::move(options), Link(*std::move(link), clock))));
  absl::Status opened = absl::OkStatus();
  if (connect) opened = store->impl_->Trusted().status();
  if (!opened.ok() && !IsWorthRetry(opened)) return opened;
  store->impl_->open_error = std::move(opened);
  return store;
}

const absl::Status& PostgresStore::open_error() const { return impl_->open_error; }

StoreFacts PostgresStore::facts() const {
  return {impl_->unsafe.load(), milliseconds(impl_->clock_offset_ms.load()),
          impl_->commits_in_doubt.load()};
}

template <typename Work>
auto PostgresStore::With(const Work& work) -> std::invoke_result_t<Work, Connection&> {
  std::invoke_result_t<Work, Connection&> result = absl::AbortedError("not tried");
  for (int tries = 0; tries < kTriesMax && absl::IsAborted(result.status()); ++tries) {
    const absl::StatusOr<Connection*> connection = impl_->Trusted();
    if (!connection.ok()) return connection.status();
    result = work(**connection);
  }
  if (IsInDoubt(result.status())) ++impl_->commits_in_doubt;
  if (result.ok() && impl_->options.after_commit) {
    absl::Status told = impl_->options.after_commit();
    if (!told.ok()) return told;
  }
  return result;
}

absl::StatusOr<std::vector<OpenResult>> PostgresStore::OpenStreams(
    std::span<const OpenRequest> requests) {
  const StoreOptions& options = impl_->options;
  return With([&](Connection& connection) {
    return OpenAll(connection, requests, options.process, options.before_commit);
  });
}

absl::StatusOr<std::vector<AdoptResult>> PostgresStore::Adopt(
    std::span<const AdoptRequest> requests) {
  const StoreOptions& options = impl_->options;
  return With([&](Connection& connection) {
    return AdoptAll(connection, requests, options.process, options.before_commit);
  });
}

absl::StatusOr<std::vector<ClaimResult>> PostgresStore::ClaimDrones(
    std::span<const ClaimRequest> requests) {
  const StoreOptions& options = impl_->options;
  return With([&](Connection& connection) {
    return ClaimAll(connection, requests, options.process, options.before_commit);
  });
}

absl::StatusOr<std::vector<Outcome>> PostgresStore::Commit(const Batch& batch) {
  const StoreOptions& options = impl_->options;
  return With([&](Connection& connection) {
    BatchCommit commit(connection, batch, {options.process, options.rules}, options.before_commit);
    auto outcomes = commit.Run();
    if (outcomes.ok()) impl_->runs_closed += commit.runs_closed();
    return outcomes;
  });
}

absl::StatusOr<Swept> PostgresStore::Sweep(SystemTime now) {
  const StoreOptions& options = impl_->options;
  return With([&](Connection& connection) {
    return SweepRows(connection, now, options.rules, options.before_commit);
  });
}

absl::StatusOr<std::size_t> PostgresStore::CloseRuns(SystemTime now) {
  if (!Vouches(impl_->options.rules.clock, now)) return 0;
  return With([&](Connection& connection) {
    return CloseOldRuns(connection, now, impl_->options.before_commit);
  });
}

absl::StatusOr<std::vector<ProcessId>> PostgresStore::ProcessesWithOpenConnections() {
  return With([&](Connection& connection) {
    return postgres::ProcessesWithOpenConnections(connection, impl_->options.process);
  });
}

absl::StatusOr<std::size_t> PostgresStore::EndConnections(const ProcessId& process,
                                                          SystemTime now) {
  return With([&](Connection& connection) {
    return postgres::EndConnections(connection, process, now, impl_->options.before_commit);
  });
}

std::size_t PostgresStore::TakeRunsClosed() { return std::exchange(impl_->runs_closed, 0); }

absl::StatusOr<Trimmed> PostgresStore::TrimQuarantine(std::span<const std::string> ruris) {
  return With([&](Connection& connection) {
    return postgres::TrimQuarantine(connection, ruris, impl_->options.before_commit);
  });
}

absl::StatusOr<Erased> PostgresStore::Retain(SystemTime now) {
  const absl::StatusOr<Connection*> connection = impl_->Trusted();
  if (!connection.ok()) return connection.status();
  return RetainRows(**connection, now, impl_->options.rules, impl_->quarantine_days);
}

absl::StatusOr<std::vector<std::size_t>> PostgresStore::Checkpoint(std::span<const LiveRow> rows) {
  const StoreOptions& options = impl_->options;
  return With([&](Connection& connection) {
    return WriteLive(connection, rows, {options.process, ++impl_->checkpoints},
                     options.before_commit);
  });
}

bool PostgresStore::InDoubt() const {
  const Link& link = impl_->link;
  return impl_->trusted != 0 && (!link.connected() || link.connections() != impl_->trusted);
}

absl::StatusOr<std::vector<FoundRobot>> PostgresStore::Compare(std::span<const ToldRobot> robots) {
  const absl::StatusOr<Connection*> connection = impl_->Connected();
  if (!connection.ok()) return connection.status();
  return CompareAll(**connection, robots, impl_->options.process);
}

std::string PostgresStore::ServerRun() const { return impl_->link.facts().run; }

void PostgresStore::EndDoubt() { impl_->trusted = impl_->link.connections(); }

}  // namespace uplink::storage::postgres
