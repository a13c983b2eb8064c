#include "server/http/event_answer.h"

#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <fmt/core.h>

#include "server/http/header_text.h"

namespace uplink::http {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

/// Of a client that has nothing to say.
constexpr std::size_t kDiscardedMax = 64UL * 1024;
constexpr std::chrono::seconds kLingerWait{1};
constexpr const char* kComment = ":\n\n";
constexpr const char* kDenied =
    "event: end\ndata: {\"error\":{\"code\":\"UNAUTHENTICATED\",\"message\":\"the caller may no "
    "longer ask for this\"}}\n\n";

/// The end of the connection is the end of the answer.
std::string HeadOf(SystemTime now) {
  return fmt::format(
      "HTTP/1.1 200 OK\r\nDate: {}\r\nContent-Type: text/event-stream\r\n"
      "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nX-Accel-Buffering: no\r\n"
      "Connection: close\r\n\r\n",
      ImfFixdate(now));
}

}  // namespace

EventAnswer::EventAnswer(Parts parts)
    : parts_(std::move(parts)),
      comment_(parts_.wire.get_executor()),
      judgement_(parts_.wire.get_executor()) {}

void EventAnswer::Begin() {
  // The reference moves along, so that the connection always ends on the loop's thread.
  parts_.events->OnReady(
      [this, weak = parts_.connection, executor = parts_.wire.get_executor()]() mutable {
        if (Self self = weak.lock()) {
          asio::post(executor, [this, moved = std::move(self)] { Pump(); });
        }
      });
  parts_.wire.raw().expires_never();
  Read();
  AwaitComment();
  AwaitJudgement();
  busy_ = true;
  Write(HeadOf(parts_.context.server.clock.System()));
}

void EventAnswer::End() {
  closed_ = true;
  comment_.cancel();
  judgement_.cancel();
  if (job_) job_->Withdraw();
}

void EventAnswer::Pump() {
  if (closed_ || over_) return;
  if (busy_) {
    again_ = true;
    return;
  }
  Self self = parts_.connection.lock();
  if (self == nullptr) return;
  busy_ = true;
  again_ = false;
  job_ = PostedJob::Post(
      parts_.context, Lane::kWatch,
      [this, events = parts_.events, executor = parts_.wire.get_executor(),
       self = std::move(self)]() mutable {
        EventStream::Taken taken = events->Take();
        asio::post(executor, [this, moved = std::move(self), got = std::move(taken)]() mutable {
          job_.reset();
          OnTaken(std::move(got));
        });
      });
  if (!job_) Close();
}

void EventAnswer::OnTaken(EventStream::Taken taken) {
  if (closed_) return;
  // What was made for it meanwhile is not shown.
  if (denied_) return Deny();
  over_ = over_ || taken.over;
  if (!taken.text.empty()) return Write(std::move(taken.text));
  busy_ = false;
  if (over_) return Finish();
  if (again_) Pump();
}

void EventAnswer::Write(std::string text) {
  Self self = parts_.connection.lock();
  if (self == nullptr) return;
  text_ = std::move(text);
  parts_.wire.raw().expires_after(kEventsTaken);
  asio::async_write(parts_.wire, asio::buffer(text_),
                    [this, moved = std::move(self)](error_code error, std::size_t) {
                      text_ = std::string();
                      busy_ = false;
                      if (error) return Close();
                      if (over_) return Finish();
                      if (denied_) return Deny();
                      Pump();
                    });
}

void EventAnswer::Read() {
  Self self = parts_.connection.lock();
  if (self == nullptr) return;
  parts_.wire.async_read_some(asio::buffer(discard_),
                              [this, moved = std::move(self)](error_code error, std::size_t n) {
                                discarded_ += n;
                                if (error || discarded_ > kDiscardedMax) return Close();
                                Read();
                              });
}

void EventAnswer::AwaitComment() {
  comment_.expires_after(parts_.comment_every);
  comment_.async_wait([this, weak = parts_.connection](error_code error) {
    const Self self = weak.lock();
    if (!error && self != nullptr && !closed_) OnComment();
  });
}

void EventAnswer::OnComment() {
  if (over_) return Close();
  AwaitComment();
  if (busy_) return;
  busy_ = true;
  Write(kComment);
}

void EventAnswer::AwaitJudgement() {
  judgement_.expires_after(parts_.judge_every);
  judgement_.async_wait([this, weak = parts_.connection](error_code error) {
    const Self self = weak.lock();
    if (!error && self != nullptr && !closed_) OnJudgement();
  });
}

void EventAnswer::OnJudgement() {
  if (over_) return;
  denied_ = !parts_.may_go_on();
  if (!denied_) return AwaitJudgement();
  // What is being sent is followed by that.
  if (!busy_) Deny();
}

void EventAnswer::Deny() {
  parts_.events->NoteDenied();
  over_ = true;
  busy_ = true;
  Write(kDenied);
}

void EventAnswer::Finish() {
  error_code ignored;
  parts_.wire.raw().socket().shutdown(asio::socket_base::shutdown_send, ignored);
  comment_.expires_after(kLingerWait);
  comment_.async_wait([this, weak = parts_.connection](error_code error) {
    const Self self = weak.lock();
    if (!error && self != nullptr) Close();
  });
}

void EventAnswer::Close() {
  if (std::exchange(closed_, true)) return;
  comment_.cancel();
  judgement_.cancel();
  parts_.wire.raw().close();
}

}  // namespace uplink::http
