#include "storage/sqlite/forget_requests.h"

#include <string>
#include <utility>

#include "storage/sqlite/prepare.h"
#include "storage/sqlite/robot_hold.h"

namespace uplink::storage::sqlite {
namespace {

/// The machine's time: whoever asks runs beside the server.
constexpr std::string_view kNow = "CAST(strftime('%s', 'now') AS INTEGER)";
constexpr auto kSecondsTold =
    std::chrono::duration_cast<std::chrono::seconds>(kForgottenTold).count();
constexpr auto kSecondsAsked =
    std::chrono::duration_cast<std::chrono::seconds>(kForgetRequestLives).count();

std::string WithNow(std::string_view before, std::string_view after) {
  return std::string(before).append(kNow).append(after);
}

}  // namespace

absl::StatusOr<std::unique_ptr<SqliteForgetRequests>> SqliteForgetRequests::Make(
    Database& database) {
  std::unique_ptr<SqliteForgetRequests> requests(new SqliteForgetRequests());
  absl::Status status = requests->Prepare(database);
  if (!status.ok()) return status;
  return requests;
}

absl::Status SqliteForgetRequests::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(drop_old_, WithNow("DELETE FROM forget_requests WHERE touched_s < ", " - ?"));
  prepare.Into(ask_,
               WithNow("INSERT INTO forget_requests (ruri, end_stream, touched_s) VALUES (?, ?, ",
                       ") RETURNING number"));
  prepare.Into(answer_to_, "SELECT answer, epoch FROM forget_requests WHERE number = ?");
  prepare.Into(finish_, WithNow("UPDATE forget_requests SET finished = 1, touched_s = ",
                                ", answer = iif(?2, ?3, answer) WHERE number = ?1"));
  prepare.Into(
      pending_,
      WithNow("SELECT f.number, f.ruri, f.end_stream, f.finished, r.owner, r.epoch, f.answer"
              " FROM forget_requests AS f LEFT JOIN robots AS r ON r.ruri = f.ruri"
              " WHERE f.touched_s > ",
              " - iif(f.finished, ?1, ?2) AND (f.finished OR f.answer = 0)"
              " ORDER BY f.number DESC LIMIT ?3"));
  prepare.Into(answer_,
               "UPDATE forget_requests SET answer = ?2, epoch = ?3"
               " WHERE number = ?1 AND answer = 0 AND NOT finished");
  return prepare.status();
}

absl::StatusOr<std::uint64_t> SqliteForgetRequests::Ask(std::string_view ruri, bool end_stream) {
  absl::Status dropped = drop_old_->Run(std::int64_t{kSecondsTold});
  if (!dropped.ok()) return dropped;
  std::uint64_t number = 0;
  Rows rows = ask_->Select(ruri, std::int64_t{end_stream});
  // To the end: that is what commits it.
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return number;
    number = static_cast<std::uint64_t>(rows.Int(0));
  }
}

absl::StatusOr<AnsweredForget> SqliteForgetRequests::AnswerTo(std::uint64_t number) {
  Rows rows = answer_to_->Select(number);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found) return AnsweredForget();
  return AnsweredForget{static_cast<ForgetAnswer>(rows.Int(0)), static_cast<Epoch>(rows.Int(1))};
}

absl::Status SqliteForgetRequests::Finish(std::uint64_t number, bool removed) {
  return finish_->Run(number, std::int64_t{removed}, std::int64_t{kForgetRemoved});
}

absl::StatusOr<std::vector<PendingForget>> SqliteForgetRequests::Pending() {
  Rows rows = pending_->Select(std::int64_t{kSecondsTold}, std::int64_t{kSecondsAsked},
                               static_cast<std::int64_t>(kForgetRequestsMax));
  std::vector<PendingForget> pending;
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return pending;
    pending.push_back({.number = static_cast<std::uint64_t>(rows.Int(0)),
                       .ruri = std::string(rows.Bytes(1)),
                       .end_stream = rows.Int(2) != 0,
                       .finished = rows.Int(3) != 0,
                       .removed = rows.Int(6) == kForgetRemoved,
                       .hold = HoldIn(rows, 4)});
  }
}

absl::Status SqliteForgetRequests::Answer(std::uint64_t number, const AnsweredForget& answer) {
  return answer_->Run(number, static_cast<std::int64_t>(answer.answer), answer.epoch);
}

}  // namespace uplink::storage::sqlite
