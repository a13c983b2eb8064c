#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/steady_timer.hpp>

#include "schema/base/clock.h"
#include "tests/bench/load/client.h"
#include "tools/link/http2_link.h"

namespace uplink::bench {

/// Many clients of one server, driven by the thread that calls it.
///
/// Errors: a client that is refused or cut aborts the benchmark: its figures would mean nothing.
/// Thread: confined to one thread.
class Load final {
 public:
  struct Where {
    Protocol protocol = Protocol::kRelay;
    std::function<ClientStyle(std::size_t number)> style = LiveStyle;
    link::LinkOptions link;
    /// The robots' certificates; as many robots as there are can be connected.
    const std::vector<link::Identity>* identities = nullptr;
    /// Gateways' certificates: the robots speak through these, in equal parts, each by one
    /// connection. Empty: each by itself.
    std::vector<link::Identity> gateways = {};
    /// Makes the client of that number, which connects at once, whatever stands above. Not set: one
    /// of the protocol.
    std::function<std::unique_ptr<Client>(std::size_t number)> connect = {};
  };

  /// `loop` outlives it. Loads of one loop live while any of them is driven: they answer pings.
  Load(Where where, link::Loop& loop) : where_(std::move(where)), loop_(loop), timer_(loop.io) {}
  /// Closes the connections and lets them end.
  ~Load();
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

  /// Connects robots until there are so many, `at_once` handshakes at a time.
  void ConnectUpTo(std::size_t robots, std::size_t at_once);
  /// Each robot sends this many messages, one per frame; waits until the server has acked nearly
  /// all.
  void SendEach(std::size_t messages);
  /// Each robot sends one message; waits until all are acked.
  void SendOneAndAwaitAck();
  /// Evenly spread: so many frames per second over all robots, in turn.
  void Pace(double frames_per_second, std::size_t frame_messages, milliseconds duration);
  /// Lets the clients take what comes.
  void RunFor(milliseconds duration);
  /// Aborts if a client was refused or cut.
  void CheckNoneFailed(std::size_t from = 0) const;
  /// Each robot keeps `ahead` messages unacked.
  void Flood(std::size_t ahead, std::size_t frame_messages, milliseconds duration);
  /// Connects all robots again, each until it is welcomed, with `at_once` at a time: the server was
  /// started again. Gives up after `patience`.
  [[nodiscard]] bool ConnectAgain(std::size_t at_once, milliseconds patience);

  /// Messages that all robots sent, and those of them that are acked.
  [[nodiscard]] std::uint64_t sent() const;
  [[nodiscard]] std::uint64_t acked() const;
  /// How many paced frames left more than 100 ms late: then the load was the limit.
  [[nodiscard]] std::uint64_t late() const { return late_; }

 private:
  [[nodiscard]] std::unique_ptr<Client> NewClient(std::size_t number);
  [[nodiscard]] std::unique_ptr<Client> NewThroughGateway(std::size_t number);
  void FillUp(Client& client, std::size_t ahead, std::size_t frame_messages) const;

  Where where_;
  link::Loop& loop_;
  boost::asio::steady_timer timer_;
  std::vector<std::shared_ptr<link::Http2Link>> gateways_;
  std::vector<std::unique_ptr<Client>> clients_;
  std::size_t next_ = 0;
  std::uint64_t late_ = 0;
  const SystemClock clock_{};
};

}  // namespace uplink::bench
