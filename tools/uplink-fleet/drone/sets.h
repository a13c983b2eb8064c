#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/uplink-fleet/drone/voice.h"

namespace uplink::synthetic {

/// Alerts of a drone that are active at once, and requests that wait.
inline constexpr std::size_t kActiveMax = 4;

/// The two sets that a drone says whole each time: its alerts, and its requests to operators. Each
/// comes and goes once. Thread: confined to one thread.
class DroneSets final {
 public:
  DroneSets(const DroneSpeech& speech, std::size_t first_line)
      : speech_(speech), alerts_line_(first_line), chance_(speech.voice.ChanceOf(first_line)) {}

  // Each as it is after a change: one comes, or goes; with `share` 0 nothing changes.
  [[nodiscard]] AvatarCall Alerts(double share);
  [[nodiscard]] AvatarCall Requests(double share);
  [[nodiscard]] std::size_t alerts_line() const { return alerts_line_; }
  [[nodiscard]] std::size_t requests_line() const { return alerts_line_ + 1; }

 private:
  struct Active {
    ::uncrew::v1::Alert alert;
    std::string category;
    std::string description;
  };

  void Raise(const AvatarDraft& draft);
  void Clear(const AvatarDraft& draft);
  void NoteFault(const AvatarDraft& draft, const Active& alert, bool active);
  void Open(const AvatarDraft& draft);

  DroneSpeech speech_;
  const std::size_t alerts_line_;
  Seeded chance_;
  std::vector<Active> alerts_;
  std::vector<::uncrew::v1::OperatorActionRequest> requests_;
  bool alerts_said_ = false;
  bool requests_said_ = false;
};

}  // namespace uplink::synthetic
