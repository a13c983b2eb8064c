#include "storage/postgres/own_connection.h"

#include <cstddef>
#include <utility>

#include "storage/postgres/link_options.h"
#include "storage/postgres/write/transaction.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kAnswer = "SELECT 1";
/// For this transaction alone.
constexpr std::string_view kEndIfIdle =
    "SELECT set_config('idle_in_transaction_session_timeout', $1::text, true)";

}  // namespace

absl::StatusOr<std::unique_ptr<OwnConnection>> OwnConnection::Make(const StoreOptions& options,
                                                                   const Clock& clock,
                                                                   bool when_shut_out) {
  absl::StatusOr<Link::Options> link = LinkOptionsOf(options);
  if (!link.ok()) return link.status();
  link->when_shut_out = when_shut_out;
  return std::unique_ptr<OwnConnection>(new OwnConnection(*std::move(link), clock));
}

absl::StatusOr<std::vector<Result>> OwnConnection::Write(std::vector<StoreCall> work,
                                                         std::string_view doing) {
  const absl::StatusOr<Connection*> connection = link_.Get();
  if (!connection.ok()) return connection.status();
  std::vector<StoreCall> calls = BeginCalls();
  const auto before = static_cast<std::ptrdiff_t>(calls.size());
  for (StoreCall& call : work) calls.push_back(std::move(call));
  auto results = RunAndCommitFor(**connection, std::move(calls), doing, {});
  if (!results.ok()) return results.status();
  results->erase(results->begin(), results->begin() + before);
  return results;
}

absl::StatusOr<Result> OwnConnection::Write(StoreCall call, std::string_view doing) {
  auto results = Write(PipelineOf(std::move(call)), doing);
  if (!results.ok()) return results.status();
  return std::move(results->front());
}

absl::StatusOr<Connection*> OwnConnection::Alive(milliseconds most) {
  if (link_.connected()) {
    const absl::StatusOr<Connection*> stood = link_.Get();
    if (!stood.ok()) return stood.status();
    // Without an answer it is broken, and nothing was written over it.
    static_cast<void>((*stood)->RunOne(StoreCallOf(kAnswer), "ask for a sign of life", most));
  }
  return link_.Get();
}

absl::StatusOr<std::vector<Result>> OwnConnection::ReadAndWrite(std::vector<StoreCall> read,
                                                                const Decide& decide,
                                                                std::string_view doing,
                                                                milliseconds most) {
  const absl::StatusOr<Connection*> connection = Alive(most);
  if (!connection.ok()) return connection.status();
  std::vector<StoreCall> calls = BeginCalls();
  calls.push_back(StoreCallOf(kEndIfIdle, std::to_string(kBetweenTripsMax.count())));
  const auto before = static_cast<std::ptrdiff_t>(calls.size());
  for (StoreCall& call : read) calls.push_back(std::move(call));
  auto answers = (*connection)->Run(calls, doing);
  if (!answers.ok()) return answers.status();
  answers->erase(answers->begin(), answers->begin() + before);
  absl::StatusOr<std::vector<StoreCall>> work = decide(*answers);
  if (!work.ok()) {
    // A connection on which that fails is broken, and the server ends the transaction with it.
    static_cast<void>((*connection)->RollBack());
    return work.status();
  }
  return RunAndCommitFor(**connection, *std::move(work), doing, {});
}

absl::StatusOr<std::vector<Result>> OwnConnection::Read(const std::vector<StoreCall>& calls,
                                                        std::string_view doing) {
  const absl::StatusOr<Connection*> connection = link_.Get();
  if (!connection.ok()) return connection.status();
  return (*connection)->Run(calls, doing);
}

absl::StatusOr<Result> OwnConnection::Read(StoreCall call, std::string_view doing) {
  const absl::StatusOr<Connection*> connection = link_.Get();
  if (!connection.ok()) return connection.status();
  return (*connection)->RunOne(std::move(call), doing);
}

absl::StatusOr<Result> OwnConnection::ReadAgain(const StoreCall& call, std::string_view doing) {
  return ReadAgainIfDied(link_, [&] { return Read(call, doing); });
}

absl::StatusOr<Result> OwnConnection::ReadSoon(StoreCall call, std::string_view doing,
                                               milliseconds most) {
  if (!link_.connected()) return Read(std::move(call), doing);
  const absl::StatusOr<Connection*> connection = link_.Get();
  if (!connection.ok()) return connection.status();
  return (*connection)->RunOne(std::move(call), doing, most);
}

}  // namespace uplink::storage::postgres
