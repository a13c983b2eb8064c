#include "storage/postgres/link/connection.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <libpq-fe.h>
#include <poll.h>
#include <sys/socket.h>

#include "schema/base/check.h"
#include "storage/postgres/link/connect.h"

namespace uplink::storage::postgres {
namespace {

constexpr int kBinary = 1;
constexpr milliseconds kPollSlice{50};

std::string FieldOf(const PGresult* result, int code) {
  const char* text = PQresultErrorField(result, code);
  return text == nullptr ? "" : text;
}

ServerError ErrorOf(const PGresult* result) {
  ServerError error{FieldOf(result, PG_DIAG_SQLSTATE), FieldOf(result, PG_DIAG_MESSAGE_PRIMARY)};
  if (const std::string detail = FieldOf(result, PG_DIAG_MESSAGE_DETAIL); !detail.empty()) {
    error.message += ": " + detail;
  }
  if (error.message.empty()) error.message = PQresultErrorMessage(result);
  return error;
}

/// The answer ends the session, whatever the socket says as yet.
bool EndsSession(const ServerError& error) {
  return error.sqlstate.starts_with("57P") || error.sqlstate.starts_with("08") ||
         error.sqlstate == "25P03" || error.sqlstate == "25P04";
}

}  // namespace

void Connection::Close::operator()(pg_conn* connection) const { PQfinish(connection); }

absl::StatusOr<std::unique_ptr<Connection>> Connection::Open(const ConnectionOptions& options,
                                                             const Clock& clock) {
  const absl::StatusOr<pg_conn*> connected = Connect(options, clock);
  if (!connected.ok()) return connected.status();
  auto connection = std::unique_ptr<Connection>(new Connection(Handle(*connected), options, clock));
  absl::Status set = connection->RunScript(options.session_settings, "set the session up");
  if (!set.ok()) return set;
  return connection;
}

Connection::Connection(Handle handle, const ConnectionOptions& options, const Clock& clock)
    : handle_(std::move(handle)), options_(options), clock_(clock) {
  const bool set = PQsetnonblocking(handle_.get(), 1) == 0 && PQenterPipelineMode(handle_.get());
  UPLINK_CHECK(set, "a fresh connection takes its modes");
  PQsetNoticeReceiver(handle_.get(), &Connection::OnNotice, this);
}

void Connection::OnNotice(void* connection, const pg_result* notice) {
  auto* const self = static_cast<Connection*>(connection);
  // In English, whatever the server's language is.
  if (FieldOf(notice, PG_DIAG_SEVERITY_NONLOCALIZED) != "WARNING") return;
  self->warning_ = Warning{ErrorOf(notice).message, self->taken_};
}

std::optional<std::string> Connection::last_answers_warning() const {
  // A notice may be read while the answer before its own still waits to be taken.
  if (!warning_ || warning_->after + 2 < is_preparation_.size()) return std::nullopt;
  return warning_->text;
}

int Connection::socket() const { return PQsocket(handle_.get()); }

absl::StatusOr<std::size_t> Connection::TakeNotifications(std::int64_t own_session) {
  UPLINK_CHECK(!broken_, "a broken connection is not used again");
  if (PQconsumeInput(handle_.get()) != 1) {
    return Broken("listen", PQerrorMessage(handle_.get()));
  }
  std::size_t others = 0;
  while (PGnotify* const notification = PQnotifies(handle_.get())) {
    if (notification->be_pid != own_session) ++others;
    PQfreemem(notification);
  }
  return others;
}

std::optional<uid_t> Connection::peer_user() const {
  const int socket = PQsocket(handle_.get());
  sockaddr_storage address{};
  socklen_t length = sizeof(address);
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&address), &length) != 0 ||
      address.ss_family != AF_UNIX) {
    return std::nullopt;
  }
  ucred user{};
  length = sizeof(user);
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &user, &length) != 0) return std::nullopt;
  return user.uid;
}

Connection::~Connection() = default;

absl::Status Connection::Broken(std::string_view doing, std::string_view why) {
  broken_ = true;
  died_ = true;
  std::string text = "postgresql " + where() + ": ";
  text += doing;
  text += ": ";
  text += OneLine(why);
  return absl::UnavailableError(text);
}

absl::Status Connection::NoAnswer(std::string_view doing) {
  absl::Status status = Broken(doing, "no answer within its time");
  died_ = false;
  return status;
}

absl::StatusOr<std::vector<Result>> Connection::Run(const std::vector<StoreCall>& calls,
                                                    std::string_view doing, OnError on_error) {
  return RunWithin(options_.call_timeout, calls, doing, on_error);
}

absl::StatusOr<std::vector<Result>> Connection::RunWithin(milliseconds most,
                                                          const std::vector<StoreCall>& calls,
                                                          std::string_view doing,
                                                          OnError on_error) {
  UPLINK_CHECK(!broken_, "a broken connection is not used again");
  absl::StatusOr<std::vector<Result>> results = Exchange(most, calls, doing);
  // What no row is to blame for may lie in the session: a new one is looked at anew.
  if (absl::IsInternal(results.status())) broken_ = true;
  if (results.ok() || broken_ || on_error == OnError::kLeave) return results;
  // The session is lost, so no caller may go on with it, whatever the first error allows.
  if (absl::Status rolled_back = RollBack(); !rolled_back.ok()) {
    broken_ = true;
    return absl::UnavailableError(rolled_back.message());
  }
  return results;
}

absl::StatusOr<Result> Connection::RunOne(StoreCall call, std::string_view doing,
                                          milliseconds most) {
  auto results = RunWithin(std::min(most, options_.call_timeout), PipelineOf(std::move(call)),
                           doing, OnError::kRollBack);
  if (!results.ok()) return results.status();
  return std::move(results->front());
}

absl::Status Connection::RollBack() {
  if (PQtransactionStatus(handle_.get()) == PQTRANS_IDLE) return absl::OkStatus();
  std::vector<StoreCall> calls;
  calls.push_back({"ROLLBACK", {}});
  return Exchange(options_.call_timeout, calls, "roll back").status();
}

absl::StatusOr<std::vector<Result>> Connection::Exchange(milliseconds most,
                                                         const std::vector<StoreCall>& calls,
                                                         std::string_view doing) {
  is_preparation_.clear();
  preparing_.clear();
  prepared_now_ = 0;
  taken_ = 0;
  warning_.reset();
  if (!Send(calls)) return Broken(doing, PQerrorMessage(handle_.get()));
  absl::StatusOr<std::vector<Result>> results = Receive(most, calls.size(), doing);
  if (!results.ok()) {
    for (std::size_t i = prepared_now_; i < preparing_.size(); ++i) prepared_.erase(preparing_[i]);
  }
  return results;
}

bool Connection::Send(const std::vector<StoreCall>& calls) {
  return std::ranges::all_of(calls, [this](const StoreCall& call) { return SendOne(call); }) &&
         PQpipelineSync(handle_.get()) == 1;
}

bool Connection::SendOne(const StoreCall& call) {
  std::string sql(call.sql);
  auto known = prepared_.find(sql);
  if (known == prepared_.end() && prepared_.size() < kPreparedMax) {
    // A name is never used again, even if its preparation failed.
    const std::string name = "s" + std::to_string(++names_);
    if (PQsendPrepare(handle_.get(), name.c_str(), sql.c_str(), 0, nullptr) != 1) return false;
    is_preparation_.push_back(true);
    preparing_.push_back(sql);
    known = prepared_.emplace(sql, name).first;
  }
  const auto& values = call.parameters.values();
  std::vector<const char*> pointers;
  std::vector<int> lengths;
  const std::vector<int> formats(values.size(), kBinary);
  for (const std::optional<std::string>& value : values) {
    pointers.push_back(value ? value->data() : nullptr);
    lengths.push_back(value ? static_cast<int>(value->size()) : 0);
  }
  is_preparation_.push_back(false);
  const int count = static_cast<int>(values.size());
  if (known == prepared_.end()) {
    return PQsendQueryParams(handle_.get(), sql.c_str(), count, nullptr, pointers.data(),
                             lengths.data(), formats.data(), kBinary) == 1;
  }
  return PQsendQueryPrepared(handle_.get(), known->second.c_str(), count, pointers.data(),
                             lengths.data(), formats.data(), kBinary) == 1;
}

absl::Status Connection::AwaitResult(SteadyTime deadline, std::string_view doing) {
  while (true) {
    const int unsent = PQflush(handle_.get());
    if (unsent < 0) return Broken(doing, PQerrorMessage(handle_.get()));
    if (unsent == 0 && PQisBusy(handle_.get()) == 0) return absl::OkStatus();
    const short events = unsent == 1 ? POLLIN | POLLOUT : POLLIN;
    if (clock_.Steady() >= deadline) return NoAnswer(doing);
    // In slices: TLS may hold bytes that were read from the socket and not yet handed over.
    const SteadyTime slice = std::min(deadline, clock_.Steady() + kPollSlice);
    static_cast<void>(AwaitSocket(PQsocket(handle_.get()), events, slice, clock_));
    if (PQconsumeInput(handle_.get()) != 1) return Broken(doing, PQerrorMessage(handle_.get()));
  }
}

absl::Status Connection::Take(Result result, Answers& answers, std::string_view doing) {
  switch (PQresultStatus(result.raw())) {
    case PGRES_COMMAND_OK:
    case PGRES_TUPLES_OK:
      UPLINK_CHECK(taken_ < is_preparation_.size(), "an answer to nothing");
      if (is_preparation_[taken_++]) {
        ++prepared_now_;
      } else {
        answers.results.push_back(std::move(result));
      }
      return absl::OkStatus();
    case PGRES_PIPELINE_ABORTED:
      return absl::OkStatus();
    default:
      break;
  }
  if (PQstatus(handle_.get()) == CONNECTION_BAD) {
    return Broken(doing, PQresultErrorMessage(result.raw()));
  }
  if (!answers.error) answers.error = ErrorOf(result.raw());
  if (EndsSession(*answers.error)) return Broken(doing, answers.error->message);
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Result>> Connection::Receive(milliseconds most, std::size_t calls,
                                                        std::string_view doing) {
  const SteadyTime deadline = clock_.Steady() + most;
  Answers answers;
  answers.results.reserve(calls);
  while (true) {
    absl::Status status = AwaitResult(deadline, doing);
    if (!status.ok()) return status;
    Result result(PQgetResult(handle_.get()));
    if (result.raw() == nullptr) {  // ends the answers of one statement
      if (PQstatus(handle_.get()) != CONNECTION_BAD) continue;
      return Broken(doing, PQerrorMessage(handle_.get()));
    }
    if (PQresultStatus(result.raw()) == PGRES_PIPELINE_SYNC) break;
    status = Take(std::move(result), answers, doing);
    if (!status.ok()) return status;
  }
  if (answers.error) return MakeStatus(*answers.error, where(), doing);
  return std::move(answers.results);
}

absl::Status Connection::RunScript(const std::string& sql, std::string_view doing) {
  UPLINK_CHECK(!broken_, "a broken connection is not used again");
  if (PQexitPipelineMode(handle_.get()) != 1 || PQsendQuery(handle_.get(), sql.c_str()) != 1) {
    return Broken(doing, PQerrorMessage(handle_.get()));
  }
  const SteadyTime deadline = clock_.Steady() + options_.call_timeout;
  std::optional<ServerError> error;
  while (true) {
    absl::Status ready = AwaitResult(deadline, doing);
    if (!ready.ok()) return ready;
    const Result result(PQgetResult(handle_.get()));
    if (result.raw() == nullptr) break;
    const ExecStatusType status = PQresultStatus(result.raw());
    if (status == PGRES_FATAL_ERROR && !error) error = ErrorOf(result.raw());
  }
  if (PQstatus(handle_.get()) == CONNECTION_BAD || PQenterPipelineMode(handle_.get()) != 1) {
    return Broken(doing, PQerrorMessage(handle_.get()));
  }
  if (!error) return absl::OkStatus();
  if (EndsSession(*error)) return Broken(doing, error->message);
  absl::Status failed = MakeStatus(*error, where(), doing);
  if (absl::Status rolled_back = RollBack(); !rolled_back.ok()) {
    broken_ = true;
    return absl::UnavailableError(rolled_back.message());
  }
  return failed;
}

}  // namespace uplink::storage::postgres
