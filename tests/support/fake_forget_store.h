#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/forget_store.h"

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

/// Silent robots, as the test says, and which of them were removed; it has no rows. For one thread.
class FakeRobotRemoval final : public storage::RobotRemoval {
 public:
  absl::StatusOr<std::optional<storage::RobotHold>> HoldOf(std::string_view /*ruri*/) override {
    return std::nullopt;
  }
  absl::StatusOr<std::vector<storage::TableCount>> Count(std::string_view /*ruri*/) override {
    return std::vector<storage::TableCount>();
  }
  absl::StatusOr<std::vector<storage::SilentRobot>> SilentSince(SystemTime until,
                                                                const storage::ProcessId& /*self*/,
                                                                std::string_view after) override {
    ++silent_asked;
    if (!status.ok()) return status;
    silent_until = until;
    std::vector<storage::SilentRobot> some;
    for (const auto& [ruri, epoch] : silent) {
      if (ruri > after && some.size() < storage::kSilentRobotsMax) some.push_back({ruri, epoch});
    }
    return some;
  }
  absl::StatusOr<std::optional<storage::EntryBound>> Remove(std::string_view ruri,
                                                            storage::Epoch epoch) override {
    if (!status.ok()) return status;
    if (!remove_status.ok()) return remove_status;
    silent.erase(std::string(ruri));
    removed[std::string(ruri)] = epoch;
    return storage::EntryBound{0};
  }
  absl::StatusOr<std::size_t> RemoveHistories(std::string_view /*ruri*/,
                                              storage::EntryBound /*below*/) override {
    return 0;
  }

  /// Their epochs, until they are removed.
  std::map<std::string, storage::Epoch> silent;
  int silent_asked = 0;
  std::optional<SystemTime> silent_until;
  /// The epoch by which each was removed.
  std::map<std::string, storage::Epoch> removed;
  /// Of SilentSince and Remove.
  absl::Status status;
  /// Of Remove alone.
  absl::Status remove_status;
};

/// Both fakes as one store. For one thread.
class FakeForgetStore final : public storage::ForgetStore {
 public:
  FakeRobotRemoval& removal() override { return removal_; }
  FakeForgetRequests& requests() override { return requests_; }

 private:
  FakeRobotRemoval removal_;
  FakeForgetRequests requests_;
};

}  // namespace uplink::testing
