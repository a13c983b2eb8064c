#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/http/routes.h"
#include "server/limits/key_counts.h"
#include "server/transport/call_handler.h"

namespace uplink::rpc {

/// Bytes of a request: a hundred RURIs fit.
inline constexpr std::uint64_t kRequestBytesMax = 64UL * 1024;
/// How long a request may take to come whole.
inline constexpr std::chrono::seconds kRequestWait{10};
/// Calls that are answered at a time: each may hold an answer of storage::kPageBytesMax. A call
/// whose request is not there yet holds none, and does not count.
inline constexpr std::size_t kUnaryCallsMax = 128;
/// Calls that one caller has open at a time, their requests there or not: no token and no
/// certificate takes all.
inline constexpr std::size_t kUnaryCallsPerCallerMax = kUnaryCallsMax / 4;

/// What a request asks for. A value; `run` does not throw.
struct Work {
  /// Which threads run it; kIo: at once.
  http::Lane lane = http::Lane::kRead;
  /// The answer in its wire form.
  std::function<absl::StatusOr<std::string>()> run;
};
/// Reads a request. Errors: the call ends with them.
using Ask = std::function<absl::StatusOr<Work>(std::string_view request)>;
/// Posts a job to the threads of a lane; false if it takes no more.
using PostJob = std::function<bool(http::Lane lane, std::function<void()> job)>;

/// What unary calls of all threads share: where their jobs go, and how many there are. Thread-safe;
/// it outlives them, and `post` the jobs.
class UnaryCalls final {
 public:
  PostJob post;

  /// One more call of this caller is open; false at kUnaryCallsPerCallerMax.
  [[nodiscard]] bool Open(const std::string& caller);
  /// Undoes one Open.
  void Close(const std::string& caller);
  /// One more is answered; false at kUnaryCallsMax.
  [[nodiscard]] bool BeginAnswer();
  /// Undoes one BeginAnswer.
  void EndAnswer() { --under_way_; }
  /// Calls that are answered now.
  [[nodiscard]] std::size_t under_way() const { return under_way_; }

 private:
  std::atomic<std::size_t> under_way_{0};
  std::mutex mutex_;
  limits::KeyCounts<std::string> open_;
};

/// One unary call, whose answer is made on another thread.
///
/// Thread: confined to its connection's.
class UnaryCall final : public transport::CallHandler {
 public:
  /// `caller`: what tells it from others. Errors: kResourceExhausted past kUnaryCallsPerCallerMax.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<transport::CallHandler>> Make(
      UnaryCalls& calls, transport::ServedCall& call, const Clock& clock, std::string caller,
      Ask ask);
  ~UnaryCall() override;
  UnaryCall(const UnaryCall&) = delete;
  UnaryCall& operator=(const UnaryCall&) = delete;

  // transport::CallHandler
  void Start() override;
  [[nodiscard]] std::uint64_t message_bytes_max() const override { return kRequestBytesMax; }
  void OnMessage(std::string_view bytes) override;
  void OnTooLarge(std::uint64_t bytes) override;
  void OnHalfClose() override {}
  void OnBroken(const transport::Ending& ending) override;
  void OnWritten() override {}
  void OnWake() override;
  void OnTimer() override;
  [[nodiscard]] std::optional<SteadyTime> deadline() const override { return end_by_; }
  void OnDrain(milliseconds grace) override;

 private:
  struct Answer;
  UnaryCall(UnaryCalls& calls, transport::ServedCall& call, const Clock& clock, std::string caller,
            Ask ask);
  void Tell(absl::StatusOr<std::string> answer);
  void Finish(const absl::Status& status);

  UnaryCalls& calls_;
  transport::ServedCall& call_;
  const Clock& clock_;
  const std::string caller_;
  const Ask ask_;
  bool has_request_ = false;
  /// It counts in kUnaryCallsMax.
  bool counts_ = false;
  bool over_ = false;
  /// Until when the request must come, or, while the server drains, the answer.
  std::optional<SteadyTime> end_by_;
  /// Shared with the job that makes it.
  std::shared_ptr<Answer> answer_;
};

}  // namespace uplink::rpc
