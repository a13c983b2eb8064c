#include "server/rpc/unary_call.h"

#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "server/loop/wake.h"

namespace uplink::rpc {

bool UnaryCalls::Open(const std::string& caller) {
  const std::lock_guard lock(mutex_);
  if (open_.Of(caller) >= kUnaryCallsPerCallerMax) return false;
  open_.Add(caller);
  return true;
}

void UnaryCalls::Close(const std::string& caller) {
  const std::lock_guard lock(mutex_);
  open_.Drop(caller);
}

bool UnaryCalls::BeginAnswer() {
  if (++under_way_ <= kUnaryCallsMax) return true;
  --under_way_;
  return false;
}

/// The answer on its way between two threads.
struct UnaryCall::Answer {
  std::atomic<bool> unwanted{false};
  std::mutex mutex;
  std::optional<absl::StatusOr<std::string>> text;
};

absl::StatusOr<std::unique_ptr<transport::CallHandler>> UnaryCall::Make(UnaryCalls& calls,
                                                                        transport::ServedCall& call,
                                                                        const Clock& clock,
                                                                        std::string caller,
                                                                        Ask ask) {
  if (!calls.Open(caller)) {
    return absl::ResourceExhaustedError(
        fmt::format("{} calls of this caller are open already, as many as one may have; try again",
                    kUnaryCallsPerCallerMax));
  }
  return std::unique_ptr<UnaryCall>(
      new UnaryCall(calls, call, clock, std::move(caller), std::move(ask)));
}

UnaryCall::UnaryCall(UnaryCalls& calls, transport::ServedCall& call, const Clock& clock,
                     std::string caller, Ask ask)
    : calls_(calls),
      call_(call),
      clock_(clock),
      caller_(std::move(caller)),
      ask_(std::move(ask)),
      answer_(std::make_shared<Answer>()) {}

UnaryCall::~UnaryCall() {
  answer_->unwanted = true;
  if (counts_) calls_.EndAnswer();
  calls_.Close(caller_);
}

void UnaryCall::Start() {
  end_by_ = clock_.Steady() + kRequestWait;
  call_.RequestMessage();
}

void UnaryCall::OnMessage(std::string_view bytes) {
  has_request_ = true;
  end_by_.reset();
  counts_ = calls_.BeginAnswer();
  if (!counts_) {
    return Finish(absl::ResourceExhaustedError(fmt::format(
        "the server answers {} calls at a time, and has them; try again", kUnaryCallsMax)));
  }
  absl::StatusOr<Work> work = ask_(bytes);
  if (!work.ok()) return Finish(work.status());
  if (work->lane == http::Lane::kIo) return Tell(work->run());
  const bool posted =
      calls_.post(work->lane, [answer = answer_, run = std::move(work->run), self = call_.self()] {
        if (answer->unwanted) return;
        absl::StatusOr<std::string> text = run();
        {
          const std::lock_guard lock(answer->mutex);
          answer->text = std::move(text);
        }
        self.Wake();
      });
  if (!posted) Finish(absl::UnavailableError("too many requests wait for the store; try again"));
}

void UnaryCall::OnTooLarge(std::uint64_t bytes) {
  Finish(absl::ResourceExhaustedError(
      fmt::format("the request has {} bytes, the limit is {}", bytes, kRequestBytesMax)));
}

void UnaryCall::OnWake() {
  if (over_) return;
  std::optional<absl::StatusOr<std::string>> text;
  {
    const std::lock_guard lock(answer_->mutex);
    std::swap(text, answer_->text);
  }
  if (text) Tell(*std::move(text));
}

void UnaryCall::OnTimer() {
  if (over_ || !end_by_ || clock_.Steady() < *end_by_) return;
  Finish(has_request_ ? absl::UnavailableError("the connection ends; ask again")
                      : absl::DeadlineExceededError("the request did not come whole in time"));
}

void UnaryCall::OnDrain(milliseconds grace) {
  if (!has_request_) return Finish(absl::UnavailableError("the connection ends; ask again"));
  end_by_ = clock_.Steady() + grace;
}

void UnaryCall::OnBroken(const transport::Ending& /*ending*/) {
  over_ = true;
  answer_->unwanted = true;
}

void UnaryCall::Tell(absl::StatusOr<std::string> answer) {
  if (!answer.ok()) return Finish(answer.status());
  std::string message(transport::kPrefixBytes, '\0');
  transport::PutPrefix(answer->size(), message.data());
  message += *answer;
  call_.Write(std::move(message));
  Finish(absl::OkStatus());
}

void UnaryCall::Finish(const absl::Status& status) {
  over_ = true;
  end_by_.reset();
  answer_->unwanted = true;
  call_.Finish(status);
}

}  // namespace uplink::rpc
