#include "storage/postgres/change_signal.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "storage/postgres/link/link.h"
#include "storage/postgres/link_options.h"

namespace uplink::storage::postgres {
namespace {

// A channel is the database's, so those of other databases need no other name.
constexpr std::string_view kListen = "LISTEN uplinkd_changes";
// Asked of the server: a pooler tells clients numbers of its own.
constexpr std::string_view kOwnSession = "SELECT pg_backend_pid()";
constexpr std::string_view kNotify = "NOTIFY uplinkd_changes";

/// Waits until the socket or the eventfd is ready, or the time has come; empties the eventfd.
void AwaitEither(int socket, int wake, SteadyTime until, const Clock& clock) {
  const auto left = std::chrono::ceil<milliseconds>(until - clock.Steady()).count();
  std::array<pollfd, 2> watched{pollfd{socket, POLLIN, 0}, pollfd{wake, POLLIN, 0}};
  // An interrupted poll is one that returned early.
  static_cast<void>(
      ::poll(watched.data(), watched.size(), static_cast<int>(std::max<std::int64_t>(left, 0))));
  eventfd_t count = 0;
  static_cast<void>(::eventfd_read(wake, &count));
}

}  // namespace

struct PostgresChangeSignal::Impl {
  Impl(Link::Options options, const Clock& used_clock, int eventfd)
      : link(std::move(options), used_clock), clock(used_clock), wake(eventfd) {}
  ~Impl() { ::close(wake); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  /// Fails only where the count is full, and then the eventfd is ready as well.
  void Wake() const { static_cast<void>(::eventfd_write(wake, 1)); }
  /// A connection that listens.
  absl::StatusOr<Connection*> Listening();
  /// NOTIFY, if there is something to tell and the last one is long enough ago.
  absl::Status TellWhenDue(Connection& connection);

  Link link;
  const Clock& clock;
  const int wake;
  std::atomic<bool> to_tell = false;
  std::atomic<bool> ended = false;
  // Of the thread that waits.
  /// Null: none listens.
  Connection* listening = nullptr;
  std::int64_t own_session = 0;
  SteadyTime tell_from;
};

absl::StatusOr<Connection*> PostgresChangeSignal::Impl::Listening() {
  if (listening != nullptr && !listening->broken()) return listening;
  listening = nullptr;
  const absl::StatusOr<Connection*> connection = link.Get();
  if (!connection.ok()) return connection.status();
  std::vector<StoreCall> calls;
  calls.push_back({kListen, {}});
  calls.push_back({kOwnSession, {}});
  const auto answers = (*connection)->Run(calls, "listen for changes");
  if (!answers.ok()) return answers.status();
  own_session = answers->back().Int(0, 0);
  listening = *connection;
  return listening;
}

absl::Status PostgresChangeSignal::Impl::TellWhenDue(Connection& connection) {
  if (clock.Steady() < tell_from || !to_tell.exchange(false)) return absl::OkStatus();
  tell_from = clock.Steady() + kTellEvery;
  std::vector<StoreCall> calls;
  calls.push_back({kNotify, {}});
  absl::Status told = connection.Run(calls, "tell of changes").status();
  if (!told.ok()) to_tell = true;
  return told;
}

PostgresChangeSignal::PostgresChangeSignal(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PostgresChangeSignal::~PostgresChangeSignal() = default;

absl::StatusOr<std::unique_ptr<PostgresChangeSignal>> PostgresChangeSignal::Make(
    const StoreOptions& options, const Clock& clock) {
  absl::StatusOr<Link::Options> link = LinkOptionsOf(options);
  if (!link.ok()) return link.status();
  // It writes no row, but goes where the writers go: a standby takes neither statement.
  link->purpose = Purpose::kRead;
  link->connection.connect_timeout = std::min(options.connect_timeout, kSignalCallMax);
  link->connection.call_timeout = std::min(options.call_timeout, kSignalCallMax);
  link->connection.session_settings = SessionSettings(Purpose::kRead, kSignalCallMax);
  // A NOTIFY has nothing to keep: no disk and no standby need be waited for.
  link->connection.session_settings += " SET synchronous_commit = off;";
  const int wake = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake < 0) return absl::ResourceExhaustedError("no descriptor for an eventfd");
  return std::unique_ptr<PostgresChangeSignal>(
      new PostgresChangeSignal(std::make_unique<Impl>(*std::move(link), clock, wake)));
}

void PostgresChangeSignal::Tell() {
  if (!impl_->to_tell.exchange(true)) impl_->Wake();
}

absl::StatusOr<bool> PostgresChangeSignal::Wait(milliseconds most) {
  const SteadyTime deadline = impl_->clock.Steady() + most;
  while (!impl_->ended) {
    const absl::StatusOr<Connection*> connection = impl_->Listening();
    if (!connection.ok()) return connection.status();
    const absl::Status told = impl_->TellWhenDue(**connection);
    if (!told.ok()) return told;
    const auto heard = (*connection)->TakeNotifications(impl_->own_session);
    if (!heard.ok()) return heard.status();
    if (*heard != 0) return true;
    if (impl_->clock.Steady() >= deadline) return false;
    const SteadyTime until = impl_->to_tell ? std::min(deadline, impl_->tell_from) : deadline;
    AwaitEither((*connection)->socket(), impl_->wake, until, impl_->clock);
  }
  return false;
}

void PostgresChangeSignal::End() {
  impl_->ended = true;
  impl_->Wake();
}

}  // namespace uplink::storage::postgres
