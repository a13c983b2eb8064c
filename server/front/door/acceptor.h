#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <system_error>
#include <thread>

#include <absl/status/statusor.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <sys/socket.h>

#include "server/config/address.h"
#include "server/front/loop/descriptor.h"

namespace uplink::front {

/// A connection as the system accepted it.
struct Accepted {
  Descriptor descriptor;
  sockaddr_storage peer{};
};

/// Accepts connections on one address, on a thread of its own, and hands each on.
///
/// If the process or the machine has no descriptor left, it pauses for a moment and goes on by
/// itself.
/// Thread: main; the hand runs on its own.
class Acceptor final {
 public:
  /// Takes what was accepted, on the acceptor's thread.
  using Hand = std::function<void(Accepted accepted)>;

  /// Listens; accepts nothing before Start.
  ///
  /// Errors: kUnavailable names the address and the system's reason.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<Acceptor>> Listen(
      const config::ListenAddress& address);
  /// Stops.
  ~Acceptor();
  Acceptor(const Acceptor&) = delete;
  Acceptor& operator=(const Acceptor&) = delete;

  /// Called on the acceptor's thread.
  struct Hooks {
    /// A second has passed.
    std::function<void()> tick;
    /// Accepting is paused for a moment; `why` is the system's reason.
    std::function<void(std::error_code why)> paused;
  };

  void Start(Hand hand, Hooks hooks);
  /// Runs `work` on its thread; drops it after Stop. Any thread.
  void Post(std::function<void()> work);
  /// Closes the listener and ends the thread: connections that were not accepted yet are refused.
  /// Idempotent.
  void Stop();
  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Its thread runs it.
  [[nodiscard]] boost::asio::io_context& context() { return context_; }

 private:
  Acceptor(int descriptor, std::uint16_t port);

  void Wait();
  void AcceptAll();
  /// False: accepts no more for now.
  bool AcceptOne();
  void Pause(std::error_code why);
  void Tick();

  const std::uint16_t port_;
  Hand hand_;
  Hooks hooks_;
  boost::asio::io_context context_{1};
  boost::asio::posix::stream_descriptor listener_;
  boost::asio::steady_timer pause_{context_};
  boost::asio::steady_timer second_{context_};
  std::jthread thread_;
};

}  // namespace uplink::front
