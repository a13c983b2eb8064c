#pragma once

#include <atomic>
#include <cstdint>
#include <list>
#include <stop_token>
#include <string>
#include <thread>

#include "schema/base/clock.h"

namespace uplink::testing {

/// What a FaultProxy does to what passes through it.
enum class ProxyMode : std::uint8_t {
  kPass,
  /// Connections are refused, and what was connected is cut. The port stays ours: another program
  /// could take it meanwhile, on a busy machine.
  kRefuse,
  /// Connections are taken and stand; not a byte passes.
  kBlackHole,
  /// Every piece passes kProxyDelay later.
  kDelay,
  /// Replies pass kTrickleBytes at a time.
  kTrickle,
};

inline constexpr milliseconds kProxyDelay{40};
inline constexpr std::size_t kTrickleBytes = 7;

/// A TCP proxy on loopback before a server that a test makes trouble with.
///
/// Thread: thread-safe; a thread of its own moves the bytes.
class FaultProxy final {
 public:
  /// Listens on a free port and leads to `target_port` of loopback.
  explicit FaultProxy(std::uint16_t target_port);
  ~FaultProxy();
  FaultProxy(const FaultProxy&) = delete;
  FaultProxy& operator=(const FaultProxy&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  void Set(ProxyMode mode);
  /// The next reply is cut in its middle, and its connection with it.
  void CutNextReply() { cut_reply_.store(true); }
  /// The next reply that says COMMIT is swallowed, and its connection cut: the server has
  /// committed, and the client does not know.
  void CutNextCommit() { cut_commit_.store(true); }
  /// The same of a reply that says ROLLBACK.
  void CutNextRollback() { cut_rollback_.store(true); }
  /// Connections that were cut.
  [[nodiscard]] int cuts() const { return cuts_.load(); }
  /// It takes connections: some time after Set.
  [[nodiscard]] bool listens() const { return listens_.load(); }
  /// Connections that were taken.
  [[nodiscard]] int connections() const { return connections_.load(); }

 private:
  /// Bytes of one direction that have been read and not yet written.
  struct Pipe {
    int from = -1;
    int to = -1;
    std::string waiting;
    SteadyTime due;
    bool is_reply = false;
  };
  struct Pair {
    Pipe request;
    Pipe reply;
    bool is_dead = false;
  };

  void Run(const std::stop_token& stop);
  /// A socket that is bound to the port; the first one chooses it.
  [[nodiscard]] int Bound();
  void Listen();
  void StopListening();
  void Accept();
  void Follow();
  void ReadInto(Pair& pair, Pipe& pipe);
  void WriteFrom(Pair& pair, Pipe& pipe);
  void Cut(Pair& pair);
  void Reap();

  const SystemClock clock_{};
  std::atomic<bool> listens_{false};
  const std::uint16_t target_port_;
  std::uint16_t port_ = 0;
  /// Never listens.
  int reserved_ = -1;
  int wake_ = -1;
  std::atomic<ProxyMode> mode_{ProxyMode::kPass};
  std::atomic<bool> cut_reply_{false};
  std::atomic<bool> cut_commit_{false};
  std::atomic<bool> cut_rollback_{false};
  std::atomic<int> cuts_{0};
  std::atomic<int> connections_{0};
  // The thread's own.
  int listener_ = -1;
  std::list<Pair> pairs_;
  std::jthread thread_;
};

}  // namespace uplink::testing
