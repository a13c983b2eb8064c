#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "server/front/call/thread.h"
#include "server/front/connection.h"
#include "server/front/door/door.h"
#include "server/front/loop/event_loop.h"
#include "server/loop/wake.h"

namespace uplink::front {

/// One event loop and its thread, the connections that stay on it with their calls, their timers,
/// and the inbox through which other threads wake them.
///
/// Order:  Start; Stop, which ends all connections. Wakes do nothing afterwards.
/// Thread: Adopt, CutHandshake, Evict, LookAtDenied, LookAtAuthorities, Drain, Wake, load: any;
/// Start, Stop: main; the rest: its own.
class Worker final : public loop::WakeInbox, public ConnectionOwner {
 public:
  struct Setup {
    std::string name;
    std::size_t index = 0;
    milliseconds connection_age_max{0};
    std::uint32_t gateway_streams_max = 0;
    /// Called on this thread: a handshake began, and ended; a connection of any thread must be
    /// closed.
    std::function<void(std::uint64_t)> handshake_began;
    std::function<void(std::uint64_t)> handshake_ended;
    std::function<void(std::uint64_t)> evict;
  };

  Worker(const Setup& setup, const RelayContext& relay, transport::Gate& gate,
         const transport::MethodsMaker& make_methods, const ServedContext& tls, DoorBook& book,
         Unfinished& unfinished);
  ~Worker() override;
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void Start();
  /// Takes over a connection, by the door's number.
  void Adopt(std::uint64_t id, IncomingConnection incoming);
  /// CutHandshake ends a handshake that gives way; Evict ends a connection over its certificate's
  /// bound. No effect if the connection is not here.
  void CutHandshake(std::uint64_t id);
  void Evict(std::uint64_t id);
  /// The deny list changed: looks at each connection.
  void LookAtDenied();
  /// Authorities, or what they may vouch for, changed: looks at each connection.
  void LookAtAuthorities();
  void Wake(std::uint64_t call) override;
  /// Tells every stream to drain, one after the other, over a part of the grace.
  void Drain(milliseconds grace);
  /// Ends all connections and the thread. Blocks. Idempotent.
  void Stop();
  /// Connections that it has or was given.
  [[nodiscard]] std::size_t load() const { return load_.load(std::memory_order_relaxed); }

  // ConnectionOwner
  void OnHandshakeEnded(Connection& connection) override;
  void EvictOther(std::uint64_t connection) override;
  void OnClosed(Connection& connection) override;

 private:
  void Run();
  /// Begins the handshake of the first connection that arrived; each further one waits for its
  /// turn.
  void BeginNext();
  void Begin(std::uint64_t id, IncomingConnection incoming);
  void EmptyInbox();
  void BeginDrain(milliseconds grace);
  void EndAll();
  /// Destroys closed connections.
  void Reap();
  /// Lets the thread end if Stop was called and no connection is left.
  void EndIfEmpty();
  /// Sets the loop's timer to the next one that is due.
  void SetTimer();
  void RunTimers();
  void Post(std::function<void()> work);

  const Setup setup_;
  const ServedContext& tls_;
  Thread thread_state_;
  std::unordered_map<std::uint64_t, std::unique_ptr<Connection>> connections_;
  /// Connections whose handshake must begin, at most as many as the door admits. A handshake costs
  /// far more than a message, so other ready work goes between any two.
  std::deque<std::pair<std::uint64_t, IncomingConnection>> arrived_;
  /// Closed connections to destroy.
  std::vector<std::uint64_t> closed_;
  bool ending_ = false;
  std::atomic<std::size_t> load_{0};

  std::mutex mutex_;
  /// Calls to wake, each once.
  std::unordered_set<std::uint64_t> wakes_;
  bool wake_posted_ = false;
  bool stopped_ = false;

  EventLoop loop_;
  std::optional<SteadyTime> timer_at_;
  std::jthread thread_;
};

}  // namespace uplink::front
