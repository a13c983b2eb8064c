#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/robot_removal.h"

namespace uplink::testing {

/// What an operator asks of a server, as the test says; rows are not its business. For one thread.
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
  absl::StatusOr<bool> Remove(std::string_view ruri, storage::Epoch epoch) override {
    if (!status.ok()) return status;
    if (!remove_status.ok()) return remove_status;
    silent.erase(std::string(ruri));
    removed[std::string(ruri)] = epoch;
    return true;
  }
  absl::StatusOr<std::size_t> RemoveHistories(std::string_view /*ruri*/) override { return 0; }
  absl::StatusOr<std::uint64_t> Ask(std::string_view ruri, bool end_stream) override {
    pending.push_back(
        {.number = pending.size() + 1, .ruri = std::string(ruri), .end_stream = end_stream});
    return pending.back().number;
  }
  absl::StatusOr<storage::AnsweredForget> AnswerTo(std::uint64_t number) override {
    return answers[number];
  }
  absl::Status Finish(std::uint64_t number) override {
    pending[number - 1].finished = true;
    return absl::OkStatus();
  }
  absl::StatusOr<std::vector<storage::PendingForget>> Pending() override {
    if (!status.ok()) return status;
    std::vector<storage::PendingForget> open;
    for (const storage::PendingForget& one : pending) {
      if (one.finished || !answers.contains(one.number)) open.push_back(one);
    }
    return open;
  }
  absl::Status Answer(std::uint64_t number, const storage::AnsweredForget& answer) override {
    if (!status.ok()) return status;
    if (!answer_status.ok()) return answer_status;
    answers.emplace(number, answer);
    return absl::OkStatus();
  }

  std::vector<storage::PendingForget> pending;
  std::map<std::uint64_t, storage::AnsweredForget> answers;
  /// Their epochs, until they are removed.
  std::map<std::string, storage::Epoch> silent;
  int silent_asked = 0;
  std::optional<SystemTime> silent_until;
  /// The epoch by which each was removed.
  std::map<std::string, storage::Epoch> removed;
  /// Of Pending, Answer, SilentSince and Remove.
  absl::Status status;
  /// Of these alone.
  absl::Status remove_status;
  absl::Status answer_status;
};

}  // namespace uplink::testing
