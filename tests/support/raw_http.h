#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace uplink::testing {

/// An answer as it came. A value.
struct RawAnswer {
  int status = 0;
  /// The status line and the headers.
  std::string head;
  std::string body;
};

/// One TCP connection to a port of 127.0.0.1 that sends what it is told. Reads give up after ten
/// seconds. Without a listener there it is at its end at once: the test says what that means, and
/// what its server said last. Confined to one thread.
class RawConnection final {
 public:
  /// `receive_bytes`: what the kernel may hold unread, about; 0: as it likes. `from`: its address,
  /// of 127.0.0.0/8; null: 127.0.0.1.
  explicit RawConnection(std::uint16_t port, int receive_bytes = 0, const char* from = nullptr);
  ~RawConnection();
  RawConnection(const RawConnection&) = delete;
  RawConnection& operator=(const RawConnection&) = delete;

  void Send(const std::string& bytes);
  /// Sends `GET target` with keep-alive.
  void SendGet(const std::string& target);
  /// One answer; `head_only`: to a HEAD, which has no body. Nothing if the connection ended first.
  enum class Body : std::uint8_t { kByLength, kNone };
  [[nodiscard]] std::optional<RawAnswer> Read(Body body = Body::kByLength);
  /// True once the peer has closed and nothing is left to read.
  [[nodiscard]] bool AtEnd();

 private:
  bool ReadMore();

  int socket_ = -1;
  std::string buffer_;
};

/// One GET on a connection of its own.
[[nodiscard]] RawAnswer HttpGet(std::uint16_t port, const std::string& target);

}  // namespace uplink::testing
