#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "schema/base/clock.h"
#include "server/identity/caller.h"
#include "server/rpc/unary_call.h"
#include "server/transport/call_handler.h"
#include "server/view/watches.h"

namespace uplink::rpc {

/// When changes are asked for again that the threads had no room for.
inline constexpr std::chrono::milliseconds kWatchTryAgain{200};

/// One WatchRobots: changes are taken and written on another thread, once the peer has taken those
/// before.
///
/// Thread: confined to its connection's.
class WatchCall final : public transport::CallHandler {
 public:
  /// They outlive it.
  struct Context {
    view::Watches& watches;
    const PostJob& post;
    const Clock& clock;
    /// Whether its caller may go on: asked again and again, since tokens are revoked.
    std::function<bool()> may_go_on;
  };
  WatchCall(const Context& context, transport::ServedCall& call, identity::Caller caller);
  ~WatchCall() override;
  WatchCall(const WatchCall&) = delete;
  WatchCall& operator=(const WatchCall&) = delete;

  // transport::CallHandler
  void Start() override;
  [[nodiscard]] std::uint64_t message_bytes_max() const override { return kRequestBytesMax; }
  void OnMessage(std::string_view bytes) override;
  void OnTooLarge(std::uint64_t bytes) override;
  void OnHalfClose() override {}
  void OnBroken(const transport::Ending& ending) override;
  void OnWritten() override { Take(); }
  void OnWake() override;
  void OnTimer() override;
  [[nodiscard]] std::optional<SteadyTime> deadline() const override;
  void OnDrain(milliseconds grace) override;

 private:
  struct Feed;
  /// Posts the job that takes the next changes.
  void Take();
  void Finish(const absl::Status& status, view::WatchEnd why = view::WatchEnd::kLeft);

  const Context context_;
  transport::ServedCall& call_;
  const identity::Caller caller_;
  /// Until when the request must come, or when changes are asked for again.
  std::optional<SteadyTime> look_at_;
  /// When the caller is judged again; nothing before the request.
  std::optional<SteadyTime> judge_at_;
  /// Shared with the job. Null before the request.
  std::shared_ptr<Feed> feed_;
  /// Nothing is there to take: `ready` tells.
  bool idle_ = false;
  bool over_ = false;
};

}  // namespace uplink::rpc
