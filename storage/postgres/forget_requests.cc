#include "storage/postgres/forget_requests.h"

#include <string>
#include <utility>

#include "storage/postgres/own_connection.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kAsk =
    "INSERT INTO uplinkd.forget_requests (ruri, end_stream) VALUES ($1::text, $2::int <> 0)"
    " RETURNING number";
constexpr std::string_view kDropOldRequests =
    "DELETE FROM uplinkd.forget_requests WHERE touched_at < now() - make_interval(secs => "
    "$1::int)";
constexpr std::string_view kAnswerTo =
    "SELECT answer, epoch FROM uplinkd.forget_requests WHERE number = $1::bigint";
constexpr std::string_view kFinish =
    "UPDATE uplinkd.forget_requests SET finished = true, touched_at = now(),"
    " answer = CASE WHEN $2::int <> 0 THEN $3::int ELSE answer END"
    " WHERE number = $1::bigint";
constexpr std::string_view kPending =
    "SELECT f.number, f.ruri, f.end_stream, f.finished, r.owner, r.epoch, f.answer"
    " FROM uplinkd.forget_requests AS f LEFT JOIN uplinkd.robots AS r ON r.ruri = f.ruri"
    " WHERE CASE WHEN f.finished THEN f.touched_at > now() - make_interval(secs => $1::int)"
    " ELSE f.answer = 0 AND f.touched_at > now() - make_interval(secs => $2::int) END"
    " ORDER BY f.number DESC LIMIT $3::bigint";
constexpr std::string_view kAnswer =
    "UPDATE uplinkd.forget_requests SET answer = $2::int, epoch = $3::bigint"
    " WHERE number = $1::bigint AND answer = 0 AND NOT finished";

constexpr std::int32_t SecondsOf(std::chrono::seconds time) {
  return static_cast<std::int32_t>(time.count());
}
constexpr std::int32_t kSecondsTold = SecondsOf(kForgottenTold);
constexpr std::int32_t kSecondsAsked = SecondsOf(kForgetRequestLives);

}  // namespace

absl::StatusOr<std::uint64_t> PostgresForgetRequests::Ask(std::string_view ruri, bool end_stream) {
  std::vector<StoreCall> calls;
  calls.push_back({kDropOldRequests, {}});
  calls.back().parameters.Int4(kSecondsTold);
  calls.push_back({kAsk, {}});
  calls.back().parameters.Text(ruri);
  calls.back().parameters.Int4(end_stream ? 1 : 0);
  const auto answers = connection_.Write(std::move(calls), "ask for a robot to be forgotten");
  if (!answers.ok()) return answers.status();
  return static_cast<std::uint64_t>((*answers)[1].Int(0, 0));
}

absl::StatusOr<AnsweredForget> PostgresForgetRequests::AnswerTo(std::uint64_t number) {
  std::vector<StoreCall> calls;
  calls.push_back({kAnswerTo, {}});
  calls.back().parameters.Int8(static_cast<std::int64_t>(number));
  const auto answers = connection_.Read(calls, "read an answer");
  if (!answers.ok()) return answers.status();
  const Result& rows = answers->front();
  if (rows.rows() == 0) return AnsweredForget();
  return AnsweredForget{static_cast<ForgetAnswer>(rows.Int(0, 0)),
                        static_cast<Epoch>(rows.Int(0, 1))};
}

absl::Status PostgresForgetRequests::Finish(std::uint64_t number, bool removed) {
  std::vector<StoreCall> calls;
  calls.push_back({kFinish, {}});
  calls.back().parameters.Int8(static_cast<std::int64_t>(number));
  calls.back().parameters.Int4(removed ? 1 : 0);
  calls.back().parameters.Int4(kForgetRemoved);
  return connection_.Write(std::move(calls), "tell that a robot is forgotten").status();
}

absl::StatusOr<std::vector<PendingForget>> PostgresForgetRequests::Pending() {
  std::vector<StoreCall> calls;
  calls.push_back({kPending, {}});
  calls.back().parameters.Int4(kSecondsTold);
  calls.back().parameters.Int4(kSecondsAsked);
  calls.back().parameters.Int8(static_cast<std::int64_t>(kForgetRequestsMax));
  const auto answers = connection_.Read(calls, "look for robots to be forgotten");
  if (!answers.ok()) return answers.status();
  const Result& rows = answers->front();
  std::vector<PendingForget> pending;
  for (int row = 0; row < rows.rows(); ++row) {
    PendingForget& one = pending.emplace_back();
    one.number = static_cast<std::uint64_t>(rows.Int(row, 0));
    one.ruri = std::string(rows.Bytes(row, 1));
    one.end_stream = rows.Bool(row, 2);
    one.finished = rows.Bool(row, 3);
    one.removed = rows.Int(row, 6) == kForgetRemoved;
    if (rows.Null(row, 4)) continue;
    one.hold = RobotHold{rows.Uuid(row, 4).bytes(), static_cast<Epoch>(rows.Int(row, 5))};
  }
  return pending;
}

absl::Status PostgresForgetRequests::Answer(std::uint64_t number, const AnsweredForget& answer) {
  std::vector<StoreCall> calls;
  calls.push_back({kAnswer, {}});
  calls.back().parameters.Int8(static_cast<std::int64_t>(number));
  calls.back().parameters.Int4(static_cast<std::int32_t>(answer.answer));
  calls.back().parameters.Int8(static_cast<std::int64_t>(answer.epoch));
  return connection_.Write(std::move(calls), "answer whether a robot may be forgotten").status();
}

}  // namespace uplink::storage::postgres
