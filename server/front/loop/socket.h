#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/front/loop/event_loop.h"

namespace uplink::front {

/// Bytes that a thread reads at once, for all its connections.
inline constexpr std::size_t kSharedReadBytes = 64 * 1024;
/// Bytes that one system call sends at most; the rest waits at its connection.
inline constexpr std::size_t kSendBytesMax = 64 * 1024;
/// Bytes that may wait for a peer that takes nothing; past them it is cut. TLS sends records of its
/// own even while the socket is blocked, so this bound is needed.
inline constexpr std::size_t kKeptBytesMax = 4 * kSendBytesMax;

/// Retransmissions in a row, or probes of a closed window, that nothing answered: then the peer is
/// gone. Each waits longer than the one before; so many take some 3 s.
inline constexpr int kUnansweredMax = 4;

/// Receives a socket's events, on the socket's thread, never from within a call to it.
class SocketOwner {
 public:
  virtual ~SocketOwner() = default;
  /// Bytes arrived, valid during the call.
  virtual void OnReceived(std::string_view bytes) = 0;
  /// The peer closed its side, or the connection broke: nothing more comes.
  virtual void OnReceiveEnd() = 0;
  /// All kept bytes have gone out.
  virtual void OnUnblocked() = 0;
  /// After one or several of the above.
  virtual void AfterEvent() = 0;
  /// The turn of its events.
  [[nodiscard]] virtual Turn turn() const { return Turn::kNow; }
};

/// A connected socket. It reads through the thread's buffer, sends at once, and keeps what does not
/// fit.
///
/// Thread: confined to that of its loop.
class Socket final : public ReadyOwner {
 public:
  /// Takes over the descriptor, which is non-blocking. `shared` is the thread's.
  Socket(EventLoop& loop, int descriptor, SocketOwner& owner,
         std::array<char, kSharedReadBytes>& shared)
      : loop_(loop), descriptor_(descriptor), owner_(owner), shared_(shared) {}
  ~Socket() override { Close(); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  /// Begins to report events; false if the system has no room for it.
  [[nodiscard]] bool Start() { return loop_.Watch(descriptor_, *this); }
  /// False if the connection broke.
  [[nodiscard]] bool Send(std::string_view bytes);
  /// Bytes wait for a peer that does not read.
  [[nodiscard]] bool blocked() const { return !kept_.empty(); }
  [[nodiscard]] std::size_t kept_bytes() const { return kept_.size(); }
  /// Whether the peer has taken some of the waiting bytes since the last call, and more still wait:
  /// a slow reader's sign of life. A peer with nothing to read shows none.
  [[nodiscard]] bool TakesSome();
  /// The connection broke with an error, and did not just end.
  [[nodiscard]] bool failed() const { return error_ != 0; }
  /// That error says that nothing answers any more.
  [[nodiscard]] bool timed_out() const;
  /// Nothing acknowledges our bytes, not even those with which TCP asks whether there is room.
  [[nodiscard]] bool unanswered() const;
  /// Ends our side of the connection.
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
  /// Bytes that the system took in all, and bytes that the peer had taken at the last TakesSome.
  std::uint64_t sent_ = 0;
  std::uint64_t taken_ = 0;
  /// The errno with which it broke.
  int error_ = 0;
};

}  // namespace uplink::front
