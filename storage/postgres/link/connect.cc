#include "storage/postgres/link/connect.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <libpq-fe.h>
#include <poll.h>

#include "schema/base/file_text.h"

namespace uplink::storage::postgres {
namespace {

struct Finish {
  void operator()(PGconn* connection) const { PQfinish(connection); }
};
using Handle = std::unique_ptr<PGconn, Finish>;
using Settings = std::vector<std::pair<std::string, std::string>>;

/// Bytes of a password file, whose first line is the password.
constexpr std::size_t kPasswordFileBytesMax = std::size_t{1024} * 1024;

absl::StatusOr<std::string> ReadPassword(const std::string& path) {
  const std::string where = "store.password_file " + path;
  const FileText file = ReadFileText(path, kPasswordFileBytesMax);
  if (!file.problem.empty()) return absl::FailedPreconditionError(where + " " + file.problem);
  if (file.text.empty()) {
    return absl::FailedPreconditionError(where +
                                         " is empty; write the password into its first line");
  }
  std::string line = file.text.substr(0, file.text.find('\n'));
  if (line.ends_with('\r')) line.pop_back();
  return line;
}

/// The SQLSTATE in libpq's verbose text of a refused connection: `FATAL:  28P01: password ...`.
/// libpq has no other way to it.
std::optional<ServerError> ServerErrorIn(std::string_view text) {
  constexpr std::string_view kBefore = ":  ";
  constexpr std::size_t kStateChars = 5;
  const std::size_t at = text.find(kBefore);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view rest = text.substr(at + kBefore.size());
  const std::string_view state = rest.substr(0, kStateChars);
  const auto is_state_char = [](unsigned char c) { return std::isdigit(c) || std::isupper(c); };
  if (state.size() < kStateChars || !std::ranges::all_of(state, is_state_char) ||
      !rest.substr(kStateChars).starts_with(": ")) {
    return std::nullopt;
  }
  std::string_view message = rest.substr(kStateChars + 2);
  message = message.substr(0, message.find('\n'));
  return ServerError{std::string(state), std::string(message)};
}

absl::Status Refused(PGconn* connection, const std::string& where) {
  const std::string_view text = PQerrorMessage(connection);
  if (const auto error = ServerErrorIn(text)) return MakeConnectStatus(*error, where);
  const std::string sentence = "postgresql " + where + ": connect: " + OneLine(text);
  if (PQconnectionNeedsPassword(connection) == 1) {
    return absl::InternalError(sentence + "; name a file with the role's password");
  }
  return absl::UnavailableError(sentence);
}

absl::StatusOr<pg_conn*> ConnectTo(const Settings& settings, const ConnectionOptions& options,
                                   const Clock& clock) {
  std::vector<const char*> keywords;
  std::vector<const char*> values;
  for (const auto& [keyword, value] : settings) {
    keywords.push_back(keyword.c_str());
    values.push_back(value.c_str());
  }
  keywords.push_back(nullptr);
  values.push_back(nullptr);
  const std::string& where = options.url.shown;
  Handle handle(PQconnectStartParams(keywords.data(), values.data(), 0));
  if (handle == nullptr) return absl::ResourceExhaustedError("no memory for a connection");
  PQsetErrorVerbosity(handle.get(), PQERRORS_VERBOSE);
  const SteadyTime deadline = clock.Steady() + options.connect_timeout;
  PostgresPollingStatusType status =
      PQstatus(handle.get()) == CONNECTION_BAD ? PGRES_POLLING_FAILED : PGRES_POLLING_WRITING;
  while (status != PGRES_POLLING_OK) {
    if (status == PGRES_POLLING_FAILED) return Refused(handle.get(), where);
    const short events = status == PGRES_POLLING_READING ? POLLIN : POLLOUT;
    if (!AwaitSocket(PQsocket(handle.get()), events, deadline, clock).ok()) {
      return absl::UnavailableError("postgresql " + where + ": connect: no answer within " +
                                    std::to_string(options.connect_timeout.count()) + " ms");
    }
    status = PQconnectPoll(handle.get());
  }
  PQsetErrorVerbosity(handle.get(), PQERRORS_DEFAULT);
  // Notices (`relation exists, skipping`) are for people at a terminal.
  PQsetNoticeProcessor(
      handle.get(), [](void*, const char*) {}, nullptr);
  return handle.release();
}

}  // namespace

absl::Status AwaitSocket(int socket, short events, SteadyTime deadline, const Clock& clock) {
  while (true) {
    const auto left =
        std::chrono::duration_cast<milliseconds>(deadline - clock.Steady()) + milliseconds(1);
    if (left.count() <= 0) return absl::DeadlineExceededError("no answer in time");
    pollfd watched{socket, events, 0};
    const int ready = poll(&watched, 1, static_cast<int>(left.count()));
    if (ready > 0) return absl::OkStatus();
    if (ready < 0 && errno != EINTR) return absl::UnavailableError("poll failed");
  }
}

absl::StatusOr<pg_conn*> Connect(const ConnectionOptions& options, const Clock& clock) {
  Settings settings = options.url.settings;
  const auto add = [&](const std::string& keyword, const std::string& value) {
    const bool is_set =
        std::ranges::any_of(settings, [&](const auto& one) { return one.first == keyword; });
    if (!is_set) settings.emplace_back(keyword, value);
  };
  std::erase_if(settings, [](const auto& one) { return one.first == "client_encoding"; });
  settings.emplace_back("client_encoding", "UTF8");
  add("application_name", options.wants_writes ? "uplinkd" : "uplinkd reader");
  if (options.wants_writes && options.url.places.size() > 1) {
    add("target_session_attrs", "read-write");
  }
  // Sees a dead peer under a quiet connection, too.
  add("keepalives_idle", "15");
  add("keepalives_interval", "5");
  add("keepalives_count", "3");
  if (!options.password_file.empty()) {
    absl::StatusOr<std::string> password = ReadPassword(options.password_file);
    if (!password.ok()) return password.status();
    settings.emplace_back("password", *std::move(password));
  }
  absl::StatusOr<pg_conn*> connected = absl::UnavailableError("store.url names no place");
  for (const Settings& place : options.url.places) {
    Settings all = settings;
    all.insert(all.end(), place.begin(), place.end());
    connected = ConnectTo(all, options, clock);
    if (connected.ok()) return connected;
  }
  return connected;
}

}  // namespace uplink::storage::postgres
