#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/front/loop/event_loop.h"

namespace uplink::front {

/// What a thread reads at once, over all its connections.
inline constexpr std::size_t kSharedReadBytes = 64 * 1024;
/// Bytes that go out in one call of the system at most; what does not fit waits at its connection.
inline constexpr std::size_t kSendBytesMax = 64 * 1024;
/// Bytes that wait for a peer that takes nothing, past which it is cut: TLS's own records are sent
/// even while the socket is blocked, so they need this bound.
inline constexpr std::size_t kKeptBytesMax = 4 * kSendBytesMax;

/// Whom a socket tells what happens to it; on its thread, never from within a call to it.
class SocketOwner {
 public:
  virtual ~SocketOwner() = default;
  /// Bytes arrived, valid during the call.
  virtual void OnReceived(std::string_view bytes) = 0;
  /// The peer closed its side, or the connection broke: nothing more comes.
  virtual void OnReceiveEnd() = 0;
  /// All that was kept back has gone out.
  virtual void OnUnblocked() = 0;
  /// After each of the above, or several.
  virtual void AfterEvent() = 0;
  /// When its events have their turn.
  [[nodiscard]] virtual Turn turn() const { return Turn::kNow; }
};

/// A connected socket: reads through the thread's buffer, sends at once and keeps back what does
/// not fit.
///
/// Thread: confined to that of its loop.
class Socket final : public ReadyOwner {
 public:
  /// Takes the descriptor over, which does not block. `shared` is the thread's.
  Socket(EventLoop& loop, int descriptor, SocketOwner& owner,
         std::array<char, kSharedReadBytes>& shared)
      : loop_(loop), descriptor_(descriptor), owner_(owner), shared_(shared) {}
  ~Socket() override { Close(); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  /// Tells its owner from now on; false: the system has no room for it.
  [[nodiscard]] bool Start() { return loop_.Watch(descriptor_, *this); }
  /// False if the connection broke.
  [[nodiscard]] bool Send(std::string_view bytes);
  /// Bytes wait for a peer that does not read.
  [[nodiscard]] bool blocked() const { return !kept_.empty(); }
  [[nodiscard]] std::size_t kept_bytes() const { return kept_.size(); }
  /// Whether the peer has taken some of what waits for it since this was asked last, and more waits
  /// still: a sign of life of a peer that reads slowly. One that has nothing to read gives none.
  [[nodiscard]] bool TakesSome();
  /// Tells the peer that nothing follows.
  void EndOutput();
  void Close();

  void OnReady(std::uint32_t events) override;
  [[nodiscard]] Turn turn() const override { return owner_.turn(); }

 private:
  void Receive();
  void SendKept();
  [[nodiscard]] bool closed() const { return descriptor_ < 0; }

  EventLoop& loop_;
  /// Below 0: closed.
  int descriptor_;
  SocketOwner& owner_;
  std::array<char, kSharedReadBytes>& shared_;
  std::string kept_;
  /// Bytes that the system took in all, and of those the peer's by the last TakesSome.
  std::uint64_t sent_ = 0;
  std::uint64_t taken_ = 0;
};

}  // namespace uplink::front
