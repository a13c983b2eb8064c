#include "server/transport/gate.h"

#include <fmt/format.h>

namespace uplink::transport {

absl::Status Gate::Enter(const std::string& robot) {
  const std::lock_guard lock(mutex_);
  if (closed_) {
    probe_.refused_draining_total.Add();
    return absl::UnavailableError("the server drains");
  }
  if (streams_ >= streams_max_) {
    probe_.refused_full_total.Add();
    return absl::ResourceExhaustedError(
        fmt::format("the server admits no more streams: it has {}", streams_));
  }
  if (!robot.empty()) {
    std::size_t& of_robot = by_robot_[robot];
    if (of_robot >= kStreamsPerCertificateMax) {
      probe_.refused_robot_total.Add();
      return absl::ResourceExhaustedError(fmt::format(
          "the server admits no more streams of this certificate: it has {}", of_robot));
    }
    ++of_robot;
  }
  ++streams_;
  return absl::OkStatus();
}

void Gate::Leave(const std::string& robot) {
  const std::lock_guard lock(mutex_);
  --streams_;
  if (const auto found = by_robot_.find(robot); found != by_robot_.end() && --found->second == 0) {
    by_robot_.erase(found);
  }
  if (streams_ == 0) empty_.notify_all();
}

void Gate::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
}

bool Gate::closed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

std::size_t Gate::streams() const {
  const std::lock_guard lock(mutex_);
  return streams_;
}

bool Gate::WaitEmpty(milliseconds wait) const {
  std::unique_lock lock(mutex_);
  return empty_.wait_for(lock, wait, [this] { return streams_ == 0; });
}

}  // namespace uplink::transport
