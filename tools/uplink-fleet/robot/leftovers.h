#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <string_view>
#include <utility>

#include "schema/base/clock.h"
#include "tools/link/stream_connection.h"
#include "tools/uplink-fleet/robot/shared.h"

namespace uplink::synthetic {

/// A connection that its robot no longer uses and the server may not know about yet: the side that
/// lost a takeover, or one end of a half-open connection. Dropped at `until`.
///
/// Thread: confined to the loop's thread.
class Leftover final : public link::StreamEvents {
 public:
  Leftover(std::unique_ptr<link::StreamConnection> connection, SteadyTime until, Shared& shared)
      : connection_(std::move(connection)), until_(until), shared_(shared) {
    connection_->SetEvents(*this);
  }

  [[nodiscard]] bool over(SteadyTime now) const { return over_ || now >= until_; }
  /// What the robot will send on its other connection too, if this one comes too late.
  void Send(std::string_view frame) { connection_->Send(frame); }
  void Freeze() { connection_->Freeze(); }
  void Cut() { connection_->Cut(); }

  void OnConnected() override {}
  void OnMessage(std::string_view /*message*/) override {}
  void OnSent() override {}
  void OnEnded(const link::StreamEnd& end) override {
    over_ = true;
    shared_.CountEnd(end.code);
  }

 private:
  std::unique_ptr<link::StreamConnection> connection_;
  SteadyTime until_;
  Shared& shared_;
  bool over_ = false;
};

/// Connections that one robot has left behind; at it the oldest is cut.
inline constexpr std::size_t kLeftoversMax = 8;

/// The connections that a robot has left behind and that are not over yet.
///
/// Thread: confined to the loop's thread.
class Leftovers final {
 public:
  /// Makes room for one more.
  void MakeRoom() {
    if (leftovers_.size() < kLeftoversMax) return;
    leftovers_.front()->Cut();
    leftovers_.pop_front();
  }
  void Add(std::unique_ptr<Leftover> leftover) { leftovers_.push_back(std::move(leftover)); }
  void DropOver(SteadyTime now) {
    std::erase_if(leftovers_, [now](const auto& each) { return each->over(now); });
  }
  void Clear() { leftovers_.clear(); }

 private:
  std::deque<std::unique_ptr<Leftover>> leftovers_;
};

}  // namespace uplink::synthetic
