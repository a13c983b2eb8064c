#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <boost/asio/steady_timer.hpp>

#include "schema/base/clock.h"
#include "server/http/connection.h"
#include "server/http/event_stream.h"
#include "server/http/guard.h"
#include "server/http/posted_job.h"
#include "server/http/wire.h"

namespace uplink::http {

/// A comment is sent so often while nothing happens, so that proxies keep the connection, and its
/// end is noticed.
inline constexpr std::chrono::seconds kEventComment{15};
/// A client that takes longer than this for what is sent is closed.
inline constexpr std::chrono::seconds kEventsTaken{60};

/// An answer of events, until either side ends it; then the connection is closed. What comes from
/// the peer meanwhile is thrown away.
///
/// Thread: confined to the loop's thread; `connection` owns it, and is kept alive by its handlers.
class EventAnswer final {
 public:
  struct Parts {
    const ConnectionContext& context;
    Wire& wire;
    std::weak_ptr<void> connection;
    std::shared_ptr<EventStream> events;
    /// Whether the caller may still see it; asked each `judge_every`.
    std::function<bool()> may_go_on;
    milliseconds comment_every = kEventComment;
    milliseconds judge_every = kCallerJudgedEvery;
  };
  explicit EventAnswer(Parts parts);
  EventAnswer(const EventAnswer&) = delete;
  EventAnswer& operator=(const EventAnswer&) = delete;

  /// Sends the head, then events.
  void Begin();
  /// The connection is over: a job that waits for its turn is dropped.
  void End();

 private:
  using Self = std::shared_ptr<void>;

  void Pump();
  void OnTaken(EventStream::Taken taken);
  void Write(std::string text);
  void Read();
  void AwaitComment();
  void OnComment();
  void AwaitJudgement();
  void OnJudgement();
  /// Tells the client that it may not watch any more, and ends.
  void Deny();
  /// No more events; closes once the peer has read what was sent.
  void Finish();
  void Close();

  const Parts parts_;
  boost::asio::steady_timer comment_;
  boost::asio::steady_timer judgement_;
  std::optional<PostedJob> job_;
  /// Being sent.
  std::string text_;
  /// Something is taken or sent.
  bool busy_ = false;
  /// More came meanwhile.
  bool again_ = false;
  bool over_ = false;
  /// Its caller may not watch any more, and does not know it yet.
  bool denied_ = false;
  bool closed_ = false;
  std::array<char, 512> discard_{};
  std::size_t discarded_ = 0;
};

}  // namespace uplink::http
