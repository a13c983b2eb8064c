#pragma once

#include <chrono>
#include <cstddef>
#include <list>

namespace uplink::http {

/// How long a TLS handshake may take from its first byte.
inline constexpr std::chrono::seconds kHandshakeWait{10};

/// A connection whose handshake is under way.
class HandshakeHolder {
 public:
  virtual ~HandshakeHolder() = default;
  /// Ends the connection at once. Its handshake has left already.
  virtual void CutHandshake() = 0;
};

/// The TLS handshakes of a listener that are under way. Past their number the one that has taken
/// longest ends. Confined to one thread.
class Handshakes final {
 public:
  using Handle = std::list<HandshakeHolder*>::iterator;

  explicit Handshakes(std::size_t most) : most_(most) {}
  Handshakes(const Handshakes&) = delete;
  Handshakes& operator=(const Handshakes&) = delete;

  [[nodiscard]] Handle Begin(HandshakeHolder& holder) {
    while (!under_way_.empty() && under_way_.size() >= most_) {
      HandshakeHolder* const oldest = under_way_.front();
      under_way_.pop_front();
      oldest->CutHandshake();
    }
    return under_way_.insert(under_way_.end(), &holder);
  }
  void End(Handle handshake) { under_way_.erase(handshake); }
  [[nodiscard]] std::size_t under_way() const { return under_way_.size(); }

 private:
  const std::size_t most_;
  std::list<HandshakeHolder*> under_way_;
};

}  // namespace uplink::http
