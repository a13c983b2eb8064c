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

/// When a descriptor that became ready has its turn. A step of a handshake costs as much as a
/// hundred messages: steps come behind everything else that is ready, a few at a time, in this
/// order.
enum class Turn : std::uint8_t {
  kNow,
  /// A handshake of the server with itself.
  kOwnHandshake,
  /// One from a source where robots streamed lately.
  kKnownHandshake,
  kHandshake,
};

/// Who is told that a descriptor became ready.
class ReadyOwner {
 public:
  virtual ~ReadyOwner() = default;
  [[nodiscard]] virtual Turn turn() const { return Turn::kNow; }
  /// May close its own descriptor, and must outlive the events that are being told: what is posted
  /// from here runs after them.
  virtual void OnReady(std::uint32_t events) = 0;
};

/// Waits for what one thread has to do: descriptors that can be read or written, one timer, and
/// what other threads post.
///
/// Not Asio's, whose sockets try to read once more after each message to find nothing, and whose
/// waits cost a call of the system each.
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
  /// Ends Run; what is posted and did not run is dropped.
  void Stop() { stopped_ = true; }
  void Post(std::function<void()> work);

  /// Tells `owner` whenever there is something to read; false: the system has no room for it. A
  /// descriptor that is closed is out by itself.
  [[nodiscard]] bool Watch(int descriptor, ReadyOwner& owner);
  /// Whether `owner` is told of room to write, too.
  void WatchSending(int descriptor, ReadyOwner& owner, bool wanted);
  /// In place of what was set before; nothing: no timer.
  void SetTimer(std::optional<SteadyTime::duration> after);

  /// Steps of handshakes behind other events: one, and one more for so many of these, so that
  /// neither waits long for the other.
  static constexpr std::size_t kEventsPerHandshake = 32;
  /// One in so many of these steps goes to the connection that became ready first.
  static constexpr std::uint64_t kFirstReadyEvery = 4;

 private:
  [[nodiscard]] Turn TurnOf(const epoll_event& event) const;
  /// Handles of the first `ready` events those whose turn is now. The others stand at the front
  /// then: how many.
  std::size_t HandleAllButHandshakes(std::size_t ready);
  /// Handles so many of the first `ready` events. Of the others the system tells again.
  void HandleHandshakes(std::size_t ready, std::size_t steps);
  void Handle(const epoll_event& event);
  void RunPosted();

  /// Events that are told before what was posted has its turn.
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
