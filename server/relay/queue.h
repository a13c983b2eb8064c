#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <unordered_map>
#include <unordered_set>

#include <grpcpp/alarm.h>
#include <grpcpp/completion_queue.h>

#include "server/identity/peer_identity.h"
#include "server/relay/service.h"
#include "server/relay/tag.h"
#include "server/robot/wake.h"
#include "server/session/session.h"
#include "server/transport/event_clock.h"
#include "server/transport/gate.h"
#include "server/transport/options.h"
#include "server/transport/timers.h"

namespace uplink::relay {

class Call;

/// Calls that a queue offers to gRPC at once. With fewer, a burst of new streams spills over to the
/// queues of other connections' threads.
inline constexpr std::size_t kOffersMax = 16;
/// One completion queue with its thread, the streams that stay on it, their timers, and the inbox
/// through which other threads wake them.
///
/// Order:  the gRPC server starts after the queues are made; Start after that; Close once the
///         server was shut down. Outlives nobody's calls: Wake does nothing once the queue has
///         closed.
/// Thread: Wake, Drain: any; Start, Close: main; the rest: its own.
class Queue final : public robot::WakeInbox {
 public:
  Queue(std::size_t index, std::unique_ptr<grpc::ServerCompletionQueue> completions,
        RelayService& service, transport::Gate& gate, const transport::RelayContext& relay);
  ~Queue() override;
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  void Start();
  void Wake(std::uint64_t stream) override;
  /// Tells every stream to drain, one after the other, over a part of the grace.
  void Drain(milliseconds grace);
  /// Ends the thread once its last call is gone. Blocks.
  void Close();

  // --- For its calls, on its thread ---

  /// One more call that waits for a robot.
  void Offer();
  /// The last tag of the call has returned; destroys it.
  void Retire(Call& call);
  /// When the call wants OnTimer.
  void CallAt(std::uint64_t id, transport::Timers::Slot& slot, SteadyTime deadline);
  void Forget(std::uint64_t id, transport::Timers::Slot& slot) { timers_.Forget(id, slot); }

  [[nodiscard]] grpc::ServerCompletionQueue& completions() { return *completions_; }
  [[nodiscard]] RelayService& service() { return service_; }
  [[nodiscard]] transport::Gate& gate() { return gate_; }
  [[nodiscard]] const transport::RelayContext& relay() const { return relay_; }
  [[nodiscard]] const session::SessionContext& session_context() const { return context_; }
  [[nodiscard]] const identity::PeerReader& peer_reader() const { return peer_reader_; }
  /// The time at the event that is being handled.
  [[nodiscard]] SteadyTime now() const { return clock_.Steady(); }

 private:
  /// The alarm has rung: the inbox holds something.
  class InboxTag final : public Tag {
   public:
    explicit InboxTag(Queue& queue) : queue_(queue) {}
    void Proceed(bool /*ok*/) override { queue_.EmptyInbox(); }

   private:
    Queue& queue_;
  };
  /// What other threads have left for this one.
  struct Inbox {
    /// Streams to wake; each once, so at most as many as there are.
    std::unordered_set<std::uint64_t> wakes;
    std::optional<milliseconds> drain;
    bool close = false;
  };

  void Run();
  void Tend();
  void EmptyInbox();
  void RunTimers();
  void BeginDrain(milliseconds grace);
  bool CloseIfDone();
  template <typename Change>
  void Post(const Change& change);
  [[nodiscard]] gpr_timespec NextDeadline();

  const std::size_t index_;
  const std::unique_ptr<grpc::ServerCompletionQueue> completions_;
  RelayService& service_;
  transport::Gate& gate_;
  const transport::RelayContext& relay_;
  transport::EventClock clock_;
  const identity::PeerReader peer_reader_;
  schema::Judge judge_;
  session::IntakeScratch scratch_;
  const session::SessionContext context_;

  transport::Timers timers_;
  /// The earliest timer, and the same on gRPC's clock.
  std::optional<SteadyTime> next_timer_;
  gpr_timespec next_deadline_ = gpr_inf_future(GPR_CLOCK_MONOTONIC);
  std::unordered_map<std::uint64_t, std::unique_ptr<Call>> calls_;
  std::uint64_t next_id_ = 1;
  bool closing_ = false;

  std::mutex mutex_;
  Inbox inbox_;
  /// A pending alarm must not be set again, nor any on a queue that is shut down: both abort.
  bool alarm_pending_ = false;
  bool closed_ = false;
  InboxTag inbox_tag_{*this};
  grpc::Alarm alarm_;

  std::jthread thread_;
};

}  // namespace uplink::relay
