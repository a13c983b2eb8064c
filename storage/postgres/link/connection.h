#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <sys/types.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/errors.h"
#include "storage/postgres/link/parameters.h"
#include "storage/postgres/link/result.h"
#include "storage/postgres/link/url.h"

struct pg_conn;
struct pg_result;

namespace uplink::storage::postgres {

/// Statements that one connection keeps prepared; a further one is sent whole each time.
inline constexpr std::size_t kPreparedMax = 256;

struct ConnectionOptions {
  Url url;
  /// A file whose first line is the password; read at each connect. Empty: as libpq finds one.
  std::string password_file;
  /// How long one place of the URL may take to connect.
  milliseconds connect_timeout{5'000};
  /// How long a call may take from its first byte to the last of its answer.
  milliseconds call_timeout{10'000};
  /// Of several places, pass those over that take no writes.
  bool wants_writes = false;
  /// `SET` statements that the session begins with.
  std::string session_settings;
};

/// One statement of a pipeline. `sql` lives as long as the connection: a constant, or the caller's.
struct StoreCall {
  std::string_view sql;
  Parameters parameters;
};

/// A call with these parameters, in order: numbers of 32 or 64 bits, texts, times, ids, and
/// pointers to arrays, which must not be used afterwards.
template <typename... Values>
[[nodiscard]] StoreCall StoreCallOf(std::string_view sql, Values&&... values) {
  StoreCall call{sql, {}};
  (call.parameters.Add(std::forward<Values>(values)), ...);
  return call;
}

/// Calls that are sent together, in order.
template <typename... Calls>
[[nodiscard]] std::vector<StoreCall> PipelineOf(Calls&&... calls) {
  std::vector<StoreCall> all;
  all.reserve(sizeof...(calls));
  (all.push_back(std::forward<Calls>(calls)), ...);
  return all;
}

/// What becomes of an open transaction when a statement fails.
enum class OnError : std::uint8_t { kRollBack, kLeave };

/// One session with a PostgreSQL server. Nothing blocks for longer than its limits.
///
/// Errors:  those of errors.h; kUnavailable where the connection broke or no answer came in time;
///          then the outcome of the call is unknown and broken() is true: make a new connection.
/// Thread:  confined to one thread at a time.
class Connection final {
 public:
  /// Tries the places of the URL in turn; the error is that of the last.
  ///
  /// Errors: kUnavailable if none could be reached, or a server is not ready to serve; kInternal if
  ///         one refuses us: no such user, password, database.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<Connection>> Open(
      const ConnectionOptions& options, const Clock& clock);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Sends all calls in one go and reads all answers: one round trip. After the first that fails
  /// the server skips the rest; an open transaction is rolled back then, in a further round trip,
  /// if `on_error` says so.
  [[nodiscard]] absl::StatusOr<std::vector<Result>> Run(const std::vector<StoreCall>& calls,
                                                        std::string_view doing,
                                                        OnError on_error = OnError::kRollBack);
  /// The same for one statement; `most`: how long it may take, if that is less than a call may.
  [[nodiscard]] absl::StatusOr<Result> RunOne(StoreCall call, std::string_view doing,
                                              milliseconds most = milliseconds::max());
  /// Ends an open transaction without its writes; OK if there is none.
  [[nodiscard]] absl::Status RollBack();
  /// Statements without parameters, as a script has them.
  [[nodiscard]] absl::Status RunScript(const std::string& sql, std::string_view doing);

  /// The WARNING that the server sent with the last answer of the last Run, or right before it
  /// (libpq hands it over as soon as it is read); nothing if there was none.
  [[nodiscard]] std::optional<std::string> last_answers_warning() const;

  /// How many notifications have come from sessions other than `own_session` (pg_backend_pid) since
  /// the last call; reads what is there and does not wait. For a session that listens.
  [[nodiscard]] absl::StatusOr<std::size_t> TakeNotifications(std::int64_t own_session);
  /// For poll(2): readable once something may have come. Valid until broken().
  [[nodiscard]] int socket() const;

  /// The user who runs the server, if it was reached by a Unix socket: then it is on this machine.
  [[nodiscard]] std::optional<uid_t> peer_user() const;
  [[nodiscard]] bool broken() const { return broken_; }
  /// It broke since the other side ended it, not for lack of an answer in time.
  [[nodiscard]] bool died() const { return died_; }
  /// `host:port/database`.
  [[nodiscard]] const std::string& where() const { return options_.url.shown; }

 private:
  struct Close {
    void operator()(pg_conn* connection) const;
  };
  using Handle = std::unique_ptr<pg_conn, Close>;

  Connection(Handle handle, const ConnectionOptions& options, const Clock& clock);
  /// libpq's notice receiver; `connection` is the Connection.
  static void OnNotice(void* connection, const pg_result* notice);
  absl::StatusOr<std::vector<Result>> RunWithin(milliseconds most,
                                                const std::vector<StoreCall>& calls,
                                                std::string_view doing, OnError on_error);
  absl::StatusOr<std::vector<Result>> Exchange(milliseconds most,
                                               const std::vector<StoreCall>& calls,
                                               std::string_view doing);
  bool Send(const std::vector<StoreCall>& calls);
  bool SendOne(const StoreCall& call);
  /// What has come of the answers to one pipeline.
  struct Answers {
    std::vector<Result> results;
    /// The first error.
    std::optional<ServerError> error;
  };
  absl::Status Take(Result result, Answers& answers, std::string_view doing);
  absl::StatusOr<std::vector<Result>> Receive(milliseconds most, std::size_t calls,
                                              std::string_view doing);
  /// Waits until a result can be taken without blocking.
  absl::Status AwaitResult(SteadyTime deadline, std::string_view doing);
  absl::Status Broken(std::string_view doing, std::string_view why);
  absl::Status NoAnswer(std::string_view doing);

  Handle handle_;
  const ConnectionOptions options_;
  const Clock& clock_;
  bool broken_ = false;
  bool died_ = false;
  std::uint64_t names_ = 0;
  /// Of the call under way: for each answer that is due, whether it is one of a preparation.
  std::vector<bool> is_preparation_;
  /// Of the call under way: the texts that it prepares, and how many of them the server has by now.
  std::vector<std::string> preparing_;
  std::size_t prepared_now_ = 0;
  /// Of the call under way: the answers that were taken, those of preparations included.
  std::size_t taken_ = 0;
  struct Warning {
    std::string text;
    /// Answers that had been taken when it came.
    std::size_t after = 0;
  };
  /// Of the call under way: the last one.
  std::optional<Warning> warning_;
  /// Statement texts to the names under which the session has them.
  std::unordered_map<std::string, std::string> prepared_;
};

}  // namespace uplink::storage::postgres
