#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/forget_requests.h"

namespace uplink::testing {

/// Requests in memory, which pass the contract of requests. For one thread.
class FakeForgetRequests final : public storage::ForgetRequests {
 public:
  absl::StatusOr<std::uint64_t> Ask(std::string_view ruri, bool end_stream) override {
    if (!status.ok()) return status;
    std::erase_if(requests_,
                  [](const auto& request) { return request.second.age > storage::kForgottenTold; });
    const std::uint64_t number = ++last_number_;
    requests_[number].asked = {
        .number = number, .ruri = std::string(ruri), .end_stream = end_stream};
    return number;
  }
  absl::StatusOr<storage::AnsweredForget> AnswerTo(std::uint64_t number) override {
    if (!status.ok()) return status;
    const auto found = requests_.find(number);
    return found == requests_.end() ? storage::AnsweredForget() : found->second.answer;
  }
  absl::Status Finish(std::uint64_t number, bool removed) override {
    if (!status.ok()) return status;
    if (const auto found = requests_.find(number); found != requests_.end()) {
      found->second.asked.finished = true;
      found->second.asked.removed = removed;
      found->second.age = {};
    }
    return absl::OkStatus();
  }
  absl::StatusOr<std::vector<storage::PendingForget>> Pending() override {
    if (!status.ok()) return status;
    std::vector<storage::PendingForget> pending;
    for (auto at = requests_.rbegin(); at != requests_.rend(); ++at) {
      if (pending.size() == storage::kForgetRequestsMax) break;
      if (!IsPending(at->second)) continue;
      pending.push_back(at->second.asked);
      pending.back().hold = hold_of(pending.back().ruri);
    }
    return pending;
  }
  absl::Status Answer(std::uint64_t number, const storage::AnsweredForget& answer) override {
    if (!status.ok()) return status;
    if (!answer_status.ok()) return answer_status;
    const auto found = requests_.find(number);
    if (found != requests_.end() && IsOpen(found->second)) found->second.answer = answer;
    return absl::OkStatus();
  }

  /// So much time passes.
  void Age(std::chrono::seconds time) {
    for (auto& [number, request] : requests_) request.age += time;
  }

  /// A robot's row, as the store has it.
  std::function<std::optional<storage::RobotHold>(const std::string& ruri)> hold_of =
      [](const std::string&) { return std::nullopt; };
  /// Of every call.
  absl::Status status;
  /// Of Answer alone.
  absl::Status answer_status;

 private:
  struct Request {
    storage::PendingForget asked;
    storage::AnsweredForget answer;
    std::chrono::seconds age{0};
  };
  static bool IsOpen(const Request& request) {
    return !request.asked.finished && request.answer.answer == storage::ForgetAnswer::kNone;
  }
  static bool IsPending(const Request& request) {
    if (request.asked.finished) return request.age < storage::kForgottenTold;
    return IsOpen(request) && request.age < storage::kForgetRequestLives;
  }

  std::map<std::uint64_t, Request> requests_;
  std::uint64_t last_number_ = 0;
};

}  // namespace uplink::testing
