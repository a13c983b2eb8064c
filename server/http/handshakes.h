#pragma once

#include <chrono>
#include <cstddef>
#include <list>

#include "server/http/source.h"
#include "server/limits/key_counts.h"

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

/// The TLS handshakes of a listener that are under way. Past their number the source that has most
/// loses its oldest one, so that who begins many keeps no other source out. Confined to one thread.
class Handshakes final {
 public:
  struct UnderWay {
    HandshakeHolder* holder = nullptr;
    Source source{};
  };
  using Handle = std::list<UnderWay>::iterator;

  explicit Handshakes(std::size_t most) : most_(most) {}
  Handshakes(const Handshakes&) = delete;
  Handshakes& operator=(const Handshakes&) = delete;

  [[nodiscard]] Handle Begin(HandshakeHolder& holder, const Source& source) {
    while (!under_way_.empty() && under_way_.size() >= most_) {
      const Handle oldest = OldestOfMost();
      HandshakeHolder* const cut = oldest->holder;
      End(oldest);
      cut->CutHandshake();
    }
    counts_.Add(source);
    return under_way_.insert(under_way_.end(), {&holder, source});
  }
  void End(Handle handshake) {
    counts_.Drop(handshake->source);
    under_way_.erase(handshake);
  }
  [[nodiscard]] std::size_t under_way() const { return under_way_.size(); }

 private:
  [[nodiscard]] Handle OldestOfMost() {
    Handle found = under_way_.begin();
    for (Handle one = under_way_.begin(); one != under_way_.end(); ++one) {
      if (counts_.Of(one->source) > counts_.Of(found->source)) found = one;
    }
    return found;
  }

  const std::size_t most_;
  std::list<UnderWay> under_way_;
  /// How many each source has.
  limits::KeyCounts<Source> counts_;
};

}  // namespace uplink::http
