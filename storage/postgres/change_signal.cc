#include "storage/change_signal.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "storage/postgres/link/link.h"
#include "storage/postgres/link_options.h"
#include "storage/postgres/parts.h"

namespace uplink::storage::postgres {
namespace {

/// What one channel is listened to and told by. A channel is the database's, so those of other
/// databases need no other name.
struct ChannelSql {
  std::string_view listen;
  std::string_view notify;
};
/// In the order of Channel.
constexpr std::array<ChannelSql, 2> kChannels = {{
    {"LISTEN uplinkd_changes", "NOTIFY uplinkd_changes"},
    {"LISTEN uplinkd_access", "NOTIFY uplinkd_access"},
}};
// Asked of the server: a pooler tells clients numbers of its own.
constexpr std::string_view kOwnSession = "SELECT pg_backend_pid()";

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

class PostgresChangeSignal final : public ChangeSignal {
 public:
  PostgresChangeSignal(Link::Options options, const Clock& clock, const ChannelSql& sql,
                       int eventfd)
      : link_(std::move(options), clock), clock_(clock), sql_(sql), wake_(eventfd) {}
  ~PostgresChangeSignal() override { ::close(wake_); }
  PostgresChangeSignal(const PostgresChangeSignal&) = delete;
  PostgresChangeSignal& operator=(const PostgresChangeSignal&) = delete;

  void Tell() override {
    if (!to_tell_.exchange(true)) Wake();
  }
  absl::StatusOr<bool> Wait(milliseconds most) override {
    const SteadyTime deadline = clock_.Steady() + most;
    while (!ended_) {
      const absl::StatusOr<Connection*> connection = Listening();
      if (!connection.ok()) return connection.status();
      const absl::Status told = TellWhenDue(**connection);
      if (!told.ok()) return told;
      const auto heard = (*connection)->TakeNotifications(own_session_);
      if (!heard.ok()) return heard.status();
      if (*heard != 0) return true;
      if (clock_.Steady() >= deadline) return false;
      const SteadyTime until = to_tell_ ? std::min(deadline, tell_from_) : deadline;
      AwaitEither((*connection)->socket(), wake_, until, clock_);
    }
    return false;
  }
  void End() override {
    ended_ = true;
    Wake();
  }

 private:
  /// Fails only where the count is full, and then the eventfd is ready as well.
  void Wake() const { static_cast<void>(::eventfd_write(wake_, 1)); }
  /// A connection that listens.
  absl::StatusOr<Connection*> Listening() {
    if (listening_ != nullptr && !listening_->broken()) return listening_;
    listening_ = nullptr;
    const absl::StatusOr<Connection*> connection = link_.Get();
    if (!connection.ok()) return connection.status();
    const auto answers = (*connection)
                             ->Run(PipelineOf(StoreCallOf(sql_.listen), StoreCallOf(kOwnSession)),
                                   "listen for changes");
    if (!answers.ok()) return answers.status();
    own_session_ = answers->back().Int(0, 0);
    listening_ = *connection;
    return listening_;
  }
  /// NOTIFY, if there is something to tell and the last one is long enough ago.
  absl::Status TellWhenDue(Connection& connection) {
    if (clock_.Steady() < tell_from_ || !to_tell_.exchange(false)) return absl::OkStatus();
    tell_from_ = clock_.Steady() + kTellEvery;
    absl::Status told = connection.RunOne(StoreCallOf(sql_.notify), "tell of changes").status();
    if (!told.ok()) to_tell_ = true;
    return told;
  }

  Link link_;
  const Clock& clock_;
  const ChannelSql sql_;
  const int wake_;
  std::atomic<bool> to_tell_ = false;
  std::atomic<bool> ended_ = false;
  // Of the thread that waits.
  /// Null: none listens.
  Connection* listening_ = nullptr;
  std::int64_t own_session_ = 0;
  SteadyTime tell_from_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<ChangeSignal>> MakeChangeSignal(const StoreOptions& options,
                                                               const Clock& clock,
                                                               Channel channel) {
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
  return std::make_unique<PostgresChangeSignal>(
      *std::move(link), clock, kChannels.at(static_cast<std::size_t>(channel)), wake);
}

}  // namespace uplink::storage::postgres
