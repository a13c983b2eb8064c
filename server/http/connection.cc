#include "server/http/connection.h"

#include <array>
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>

#include "server/http/answer_note.h"
#include "server/http/errors.h"
#include "server/http/event_answer.h"
#include "server/http/guard.h"
#include "server/http/incoming.h"
#include "server/http/posted_job.h"
#include "server/http/request_of.h"
#include "server/http/sent_answer.h"

namespace uplink::http {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

/// What is read and thrown away after the last answer, so that closing with unread bytes does not
/// reset the connection before the peer has read that answer.
constexpr std::size_t kLingerBytesMax = 64UL * 1024;
constexpr std::chrono::seconds kLingerWait{1};
constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";

class Connection final : public PlaceHolder,
                         public HandshakeHolder,
                         public std::enable_shared_from_this<Connection> {
 public:
  Connection(std::shared_ptr<ConnectionContext> context, RawStream::socket_type socket, Peer peer)
      : context_(std::move(context)),
        peer_(std::move(peer)),
        wire_(std::move(socket)),
        incoming_(context_->limits) {
    place_ =
        context_->places.Take(*this, peer_.source, context_->server.clock.Steady(), peer_.of());
    context_->probe().open.Add(1);
  }
  ~Connection() override {
    EndHandshake();
    if (place_) context_->places.Leave(*place_);
    context_->probe().open.Add(-1);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void GiveWay() override {
    // Its job may hold the last reference.
    const auto self = shared_from_this();
    place_.reset();
    gave_way_ = true;
    wire_.raw().close();
    // Else the jobs of those that gave way would take the places of others in the queue.
    if (job_) job_->Withdraw();
    if (events_) events_->End();
  }

  void CutHandshake() override {
    handshake_.reset();
    context_->probe().given_up.Add();
    wire_.raw().close();
  }

  void Begin() {
    if (context_->tls == nullptr || peer_.on_machine) return ReadRequest();
    wire_.raw().expires_after(context_->limits.idle_wait);
    const asio::mutable_buffer room = incoming_.Room();
    wire_.async_read_some(room, [self = shared_from_this(), room](error_code error, std::size_t n) {
      if (!error) self->Choose(asio::const_buffer(room.data(), n));
    });
  }

 private:
  /// The first byte says whether the peer speaks TLS.
  void Choose(asio::const_buffer first) {
    if (*static_cast<const unsigned char*>(first.data()) == kTlsHandshake) return Handshake(first);
    if (!peer_.plain) return context_->server.entrance.NoteDenied(Denied::kPlain, peer_);
    incoming_.Received(first.size());
    incoming_.Next();
    wire_.raw().expires_after(context_->limits.idle_wait);
    Advance();
  }

  void Handshake(asio::const_buffer first) {
    handshake_ = context_->handshakes.Begin(*this, peer_.source);
    wire_.raw().expires_after(kHandshakeWait);
    wire_.Handshake(judged_.Begin(*context_->tls), first,
                    [self = shared_from_this()](error_code error) {
                      self->EndHandshake();
                      if (error == asio::error::operation_aborted) return;  // it gave way
                      if (error) return self->NoteFailedHandshake(error);
                      self->judged_.Finish(self->wire_.connection());
                      self->ReadRequest();
                    });
  }

  void EndHandshake() {
    if (handshake_) context_->handshakes.End(*std::exchange(handshake_, std::nullopt));
  }

  void NoteFailedHandshake(error_code error) {
    const identity::CertificateFlaw flaw = wire_.flaw();
    if (flaw != identity::CertificateFlaw::kNone) {
      return context_->server.entrance.NoteDenied(Denied::kBadCertificate, peer_);
    }
    context_->handshake_failures.Write(log::Level::kInfo, "http_handshake_failed",
                                       {{"from", peer_.text}, {"why", error.message()}});
  }

  /// The first time and after each answer.
  void ReadRequest() {
    if (answered_any_) Note(Places::State::kIdle);
    incoming_.Next();
    wire_.raw().expires_after(context_->limits.idle_wait);
    begun_ = false;
    Advance();
  }

  void Note(Places::State state) {
    if (place_) Places::Note(*place_, state, context_->server.clock.Steady());
  }

  void Advance() {
    const Incoming::Step step = incoming_.Advance();
    if (step == Incoming::Step::kNothing) return ReadMore();
    if (!std::exchange(begun_, true)) wire_.raw().expires_after(context_->limits.request_wait);
    switch (step) {
      case Incoming::Step::kNothing:
      case Incoming::Step::kPart:
        return ReadMore();
      case Incoming::Step::kExpects:
        return SendContinue();
      case Incoming::Step::kWhole:
        return OnRequest();
      case Incoming::Step::kRefused:
        return OnRefused();
    }
  }

  void ReadMore() {
    wire_.async_read_some(incoming_.Room(),
                          [self = shared_from_this()](error_code error, std::size_t n) {
                            if (error) return;  // the peer is gone, or took too long
                            self->incoming_.Received(n);
                            self->Advance();
                          });
  }

  void SendContinue() {
    asio::async_write(wire_, asio::buffer(kContinue),
                      [self = shared_from_this()](error_code error, std::size_t) {
                        if (!error) self->Advance();
                      });
  }

  void OnRefused() {
    started_ = context_->server.clock.Steady();
    route_ = OtherRoute();
    method_ = MethodOf(incoming_.message());
    keep_alive_ = false;
    Answer(std::move(incoming_.refusal()));
  }

  [[nodiscard]] Request ToRequest() {
    Request request = RequestOf(incoming_.message(), peer_, peer_.proxy && !wire_.is_tls());
    if (wire_.is_tls()) request.certificate = judged_.Now(*context_->tls, wire_.connection());
    request.monitoring_only = place_ && (*place_)->monitoring_only;
    request.listener = context_->listener;
    return request;
  }

  void OnRequest() {
    started_ = context_->server.clock.Steady();
    method_ = MethodOf(incoming_.message());
    version_ = incoming_.message().version();
    keep_alive_ = incoming_.keep_alive();
    Resolved resolved = context_->server.entrance.Resolve(ToRequest());
    Note(IsScrape(resolved.lane) ? Places::State::kScraping : Places::State::kBusy);
    route_ = resolved.route;
    if (resolved.lane == Lane::kIo) return Answer(resolved.run());

    wire_.raw().expires_never();  // the answer's time is the store's
    job_ = PostedJob::Post(
        *context_, resolved.lane,
        [self = shared_from_this(), run = std::move(resolved.run)]() mutable {
          // A connection that has given way meanwhile needs no answer.
          Response response = self->gave_way_ ? Response() : run();
          // The reference moves along, so that the connection always ends on the loop's thread.
          asio::any_io_executor executor = self->wire_.get_executor();
          asio::post(executor, [moved = std::move(self), answer = std::move(response)]() mutable {
            moved->job_.reset();
            if (!moved->gave_way_) moved->Answer(std::move(answer));
          });
        });
    if (!job_) Answer(IsScrape(resolved.lane) ? TooManyScrapes() : TooBusy());
  }

  /// Events go on until either side ends them.
  void AnswerEvents(const Response& answer) {
    const SteadyTime now = context_->server.clock.Steady();
    if (!place_ || !context_->places.Watch(*place_, answer.events->caller(), now)) {
      return Answer(TooManyWatches("too many of http.connections_max are watches already"));
    }
    NoteAnswered(context_->server, route_, answer.status, started_);
    events_.emplace(EventAnswer::Parts{
        *context_, wire_, weak_from_this(), answer.events, [this, request = ToRequest()]() mutable {
          if (wire_.is_tls()) request.certificate = judged_.Now(*context_->tls, wire_.connection());
          return context_->server.entrance.Resolve(request).lane != Lane::kIo;
        }});
    events_->Begin();
  }

  void Answer(Response answer) {
    if (answer.events != nullptr && method_ == Method::kGet) return AnswerEvents(answer);
    if (answer.closes || (place_ && context_->places.Crowded(*place_))) keep_alive_ = false;
    answered_any_ = true;
    // A client that is refused because no place is free has no place to keep.
    Note(answer.closes ? Places::State::kIdle : Places::State::kAnswering);
    NoteAnswered(context_->server, route_, answer.status, started_);
    wire_.raw().expires_after(context_->limits.answer_wait);
    const SentAnswer::Form form{.version = version_,
                                .head_only = method_ == Method::kHead || answer.status == 304,
                                .keep_alive = keep_alive_,
                                .keep_alive_text = context_->keep_alive,
                                .now = context_->server.clock.System()};
    answer_.Write(wire_, std::move(answer), form,
                  [self = shared_from_this()](error_code error, std::size_t) {
                    // At once, even if the connection is kept.
                    self->answer_.Clear();
                    if (error) return;
                    if (self->keep_alive_) return self->ReadRequest();
                    self->Close();
                  });
  }

  void Close() {
    Note(Places::State::kIdle);
    wire_.raw().expires_after(kLingerWait);
    if (!wire_.is_tls()) return ShutDown();
    wire_.EndTls([self = shared_from_this()](error_code) { self->ShutDown(); });
  }

  void ShutDown() {
    error_code ignored;
    wire_.raw().socket().shutdown(asio::socket_base::shutdown_send, ignored);
    Linger();
  }

  void Linger() {
    wire_.raw().async_read_some(asio::buffer(discard_),
                                [self = shared_from_this()](error_code error, std::size_t n) {
                                  self->lingered_ += n;
                                  if (!error && self->lingered_ < kLingerBytesMax) self->Linger();
                                });
  }

  const std::shared_ptr<ConnectionContext> context_;
  const Peer peer_;
  /// That of the request, until the loop has its answer.
  std::optional<PostedJob> job_;
  /// Nothing once it gave way.
  std::optional<Places::Handle> place_;
  /// While its handshake is under way.
  std::optional<Handshakes::Handle> handshake_;
  Wire wire_;
  JudgedCertificate judged_;
  /// Read by the thread that answers, too.
  std::atomic<bool> gave_way_{false};
  Incoming incoming_;
  /// Something of the request has come.
  bool begun_ = false;
  SentAnswer answer_;
  std::optional<EventAnswer> events_;
  Method method_ = Method::kGet;
  RouteId route_ = OtherRoute();
  unsigned version_ = 11;
  bool answered_any_ = false;
  bool keep_alive_ = false;
  SteadyTime started_;
  std::array<char, 4096> discard_;
  std::size_t lingered_ = 0;
};

}  // namespace

void ServeConnection(const std::shared_ptr<ConnectionContext>& context,
                     RawStream::socket_type socket, Peer peer) {
  std::make_shared<Connection>(context, std::move(socket), std::move(peer))->Begin();
}

}  // namespace uplink::http
