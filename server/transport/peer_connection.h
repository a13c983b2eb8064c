#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "server/identity/shown_certificate.h"
#include "server/transport/end_cause.h"

namespace uplink::transport {

/// A peer's connection as the handlers of its calls see it: where it comes from, which certificate
/// it has shown, and why it ends. It outlives its calls.
///
/// Thread: confined to the connection's.
class PeerConnection final {
 public:
  /// What a method keeps for a connection beyond its calls. Destroyed with the connection.
  class User {
   public:
    virtual ~User() = default;
    /// The connection has ended, and so have its calls. Called once.
    virtual void OnConnectionEnd(EndCause cause) = 0;
  };

  /// Both outlive it. `address`: the peer's own address and port, also behind a load balancer.
  PeerConnection(const std::string& address, const identity::ShownCertificate& certificate)
      : address_(address), certificate_(certificate) {}
  PeerConnection(const PeerConnection&) = delete;
  PeerConnection& operator=(const PeerConnection&) = delete;

  [[nodiscard]] const std::string& address() const { return address_; }
  [[nodiscard]] const identity::ShownCertificate& certificate() const { return certificate_; }

  /// It ends for this; the first cause counts.
  void NoteEnd(EndCause cause) {
    if (!end_) end_ = cause;
  }
  /// Its calls were told to settle for this; the first cause counts.
  void NoteDrain(EndCause cause) {
    if (!drain_) drain_ = cause;
  }
  /// Why it ends; empty if nothing was noted.
  [[nodiscard]] std::optional<EndCause> noted() const { return end_ ? end_ : drain_; }
  [[nodiscard]] EndCause drain() const { return drain_.value_or(EndCause::kDrain); }

  /// Null before SetUser.
  [[nodiscard]] User* user() const { return user_.get(); }
  void SetUser(std::unique_ptr<User> user) { user_ = std::move(user); }
  /// Tells the user that it has ended. Idempotent.
  void End() {
    if (const std::unique_ptr<User> user = std::move(user_))
      user->OnConnectionEnd(noted().value_or(EndCause::kCut));
  }

 private:
  const std::string& address_;
  const identity::ShownCertificate& certificate_;
  std::optional<EndCause> end_;
  std::optional<EndCause> drain_;
  std::unique_ptr<User> user_;
};

}  // namespace uplink::transport
