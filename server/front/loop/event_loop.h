#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include <sys/epoll.h>

#include "schema/base/clock.h"

namespace uplink::front {

/// The order of ready descriptors. A step of a handshake costs as much as a hundred messages, so
/// steps come after everything else that is ready, a few at a time, in this order.
enum class Turn : std::uint8_t {
  kNow,
  /// A handshake of the server with itself.
  kOwnHandshake,
  /// A handshake from a source where robots streamed lately.
  kKnownHandshake,
  kHandshake,
};

/// Is told that a descriptor became ready.
class ReadyOwner {
 public:
  virtual ~ReadyOwner() = default;
  [[nodiscard]] virtual Turn turn() const { return Turn::kNow; }
  /// May close its own descriptor. The owner must outlive the batch of events: to destroy it, post
  /// the work, which runs after the batch.
  virtual void OnReady(std::uint32_t events) = 0;
};

/// Waits for the events of one thread: descriptors that can be read or written, one timer, and
/// posted work.
///
/// Asio is not used here: its sockets read once more after each message, to find nothing, and each
/// wait costs a system call.
/// Thread: Post: any; the rest: that of Run, or before it.
class EventLoop final {
 public:
  struct Hooks {
    /// The timer is due.
    std::function<void()> timer;
    /// Some events were handled; there may be more.
    std::function<void()> after;
  };

  explicit EventLoop(Hooks hooks);
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// Blocks until Stop.
  void Run();
  /// Ends Run; posted work that did not run is dropped.
  void Stop() { stopped_ = true; }
  void Post(std::function<void()> work);

  /// Calls `owner` whenever there is something to read; false if the system has no room for it.
  /// Closing a descriptor ends its watch.
  [[nodiscard]] bool Watch(int descriptor, ReadyOwner& owner);
  /// Sets whether `owner` also gets an event when there is room to write.
  void WatchSending(int descriptor, ReadyOwner& owner, bool wanted);
  /// Replaces the timer; empty: none.
  void SetTimer(std::optional<SteadyTime::duration> after);

  /// Handshake steps after other events: one, and one more for each so many events, so that neither
  /// waits long for the other.
  static constexpr std::size_t kEventsPerHandshake = 32;
  /// One in so many of these steps goes to the connection that became ready first.
  static constexpr std::uint64_t kFirstReadyEvery = 4;

 private:
  [[nodiscard]] Turn TurnOf(const epoll_event& event) const;
  /// Handles those of the first `ready` events whose turn is now. Moves the others to the front and
  /// returns how many they are.
  std::size_t HandleAllButHandshakes(std::size_t ready);
  /// Handles so many of the first `ready` events. The system reports the others again.
  void HandleHandshakes(std::size_t ready, std::size_t steps);
  void Handle(const epoll_event& event);
  void RunPosted();

  /// Events that are handled before posted work has its turn.
  static constexpr std::size_t kEventsAtOnce = 128;

  const Hooks hooks_;
  const int set_;
  const int timer_;
  const int posts_;
  std::array<epoll_event, kEventsAtOnce> events_{};
  std::uint64_t handshake_steps_ = 0;
  bool posts_due_ = false;
  bool stopped_ = false;

  std::mutex mutex_;
  std::vector<std::function<void()>> posted_;
};

}  // namespace uplink::front
