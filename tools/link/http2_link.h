#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string_view>
#include <vector>

#include "tools/link/http2_session.h"
#include "tools/link/tls_link.h"

namespace uplink::link {

/// Whom a link tells what happens to it: on the loop's thread, never from within a call of theirs.
class LinkUser {
 public:
  virtual ~LinkUser() = default;
  virtual void OnUp() = 0;
  /// The kernel has taken all that waited.
  virtual void OnSent() = 0;
  virtual void OnDown(const absl::Status& why) = 0;
  /// After Touch: do what nghttp2's callbacks put off, now or soon.
  virtual void AfterBytes() = 0;
  virtual void Soon() = 0;
};

/// One connection that carries streams of one user, or of several.
///
/// Thread: confined to the loop's thread.
class Http2Link final : private LinkEvents {
 public:
  enum class For : std::uint8_t { kOne, kSeveral };

  Http2Link(Loop& loop, LinkOptions options, For users);
  /// Closes the connection in an orderly way.
  ~Http2Link() override;
  Http2Link(const Http2Link&) = delete;
  Http2Link& operator=(const Http2Link&) = delete;

  void Join(LinkUser& user) { users_.insert(&user); }
  void Leave(LinkUser& user);
  /// Idempotent.
  void Connect();
  /// The user will be called to do what nghttp2's callbacks put off (AfterBytes).
  void Touch(LinkUser& user);
  /// What waits goes out.
  void Flush();
  /// As for TlsLink; its users but this one are told, later, that it is down.
  void Freeze(const LinkUser& by);
  void Cut(const LinkUser& by);

  [[nodiscard]] Http2Session& http2() { return http2_; }
  [[nodiscard]] TlsLink& link() { return *link_; }
  [[nodiscard]] Loop& loop() const { return loop_; }
  [[nodiscard]] For users() const { return for_; }
  [[nodiscard]] bool up() const { return up_; }
  /// It is no more, or its peer takes no new stream.
  [[nodiscard]] bool over() const { return down_ || (up_ && !http2_.may_open()); }
  /// Within nghttp2, which must not be entered again.
  [[nodiscard]] bool busy() const { return busy_; }
  /// What comes next is what the server let go.
  [[nodiscard]] bool receiving() const { return receiving_; }

 private:
  void OnUp() override;
  void OnBytes(std::string_view bytes) override;
  void OnSent() override;
  void OnDown(const absl::Status& why) override;

  template <typename Tell>
  void TellAll(const Tell& tell);
  void TellDownLater(const LinkUser& but);
  void Produce();

  Loop& loop_;
  const For for_;
  const bool record_per_message_;
  Http2Session http2_;
  std::shared_ptr<TlsLink> link_;
  std::set<LinkUser*> users_;
  std::vector<LinkUser*> touched_;
  bool connecting_ = false;
  bool up_ = false;
  bool down_ = false;
  bool busy_ = false;
  bool receiving_ = false;
  /// Its only owner is this object: a posted job sees by a weak_ptr that the link is gone.
  std::shared_ptr<Http2Link*> self_ = std::make_shared<Http2Link*>(this);
};

}  // namespace uplink::link
