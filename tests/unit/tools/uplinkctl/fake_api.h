#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/manual_clock.h"
#include "tools/uplinkctl/ask/api.h"
#include "tools/uplinkctl/verbs/screen.h"

namespace uplink::ctl {

/// A server that answers one after the other what a test wrote, and keeps what it was asked.
class FakeServer {
 public:
  /// The next answer.
  void Answer(unsigned status, std::string body, std::string retry_after = "") {
    answers_.push_back(link::HttpAnswer{status, std::move(body), std::move(retry_after)});
  }
  void Fail(absl::Status status) { answers_.emplace_back(std::move(status)); }

  [[nodiscard]] Api MakeApi(std::string prefix = "") {
    return {[this](const std::string& target) { return Next(target); }, std::move(prefix),
            "that of the test",
            [this](const std::string& target, const std::string& json) {
              sent.push_back(json);
              return Next(target);
            },
            [this](std::chrono::seconds time) { waited += time; }};
  }

  std::vector<std::string> asked;
  /// Bodies of commands.
  std::vector<std::string> sent;
  std::chrono::seconds waited{0};

 private:
  absl::StatusOr<link::HttpAnswer> Next(const std::string& target) {
    asked.push_back(target);
    if (asked.size() > answers_.size()) return absl::UnavailableError("no answer is left");
    return answers_[asked.size() - 1];
  }

  std::vector<absl::StatusOr<link::HttpAnswer>> answers_;
};

/// What a verb showed.
struct FakeScreen {
  testing::ManualClock clock;
  std::string printed;
  std::string notes;
  /// Looks after the first one.
  int waits = 0;

  [[nodiscard]] Screen Make() {
    return {.print = [this](std::string_view text) { printed += text; },
            .note = [this](std::string_view line) { notes += std::string(line) + '\n'; },
            .wait = [this] { return waits-- > 0; },
            .clock = clock,
            .updates = false,
            .table = {}};
  }
};

}  // namespace uplink::ctl
