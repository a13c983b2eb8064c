#include "server/http/connection.h"

#include <array>
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>

#include "server/http/answer_head.h"
#include "server/http/errors.h"
#include "server/http/header_text.h"
#include "server/http/incoming.h"
#include "server/http/posted_job.h"

namespace uplink::http {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace bhttp = boost::beast::http;
using asio::ip::tcp;

/// What is read and thrown away after the last answer, so that closing with unread bytes does not
/// reset the connection before the peer has read that answer.
constexpr std::size_t kLingerBytesMax = 64UL * 1024;
constexpr std::chrono::seconds kLingerWait{1};
constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";

Method MethodOf(bhttp::verb verb) {
  if (verb == bhttp::verb::get) return Method::kGet;
  if (verb == bhttp::verb::head) return Method::kHead;
  return Method::kOther;
}

class Connection final : public PlaceHolder, public std::enable_shared_from_this<Connection> {
 public:
  Connection(std::shared_ptr<ConnectionContext> context, tcp::socket socket, const Source& source)
      : context_(std::move(context)), stream_(std::move(socket)), incoming_(context_->limits) {
    place_ = context_->places.Take(*this, source, context_->server.clock.Steady());
    context_->probe().open.Add(1);
  }
  ~Connection() override {
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
    stream_.close();
    // Else the jobs of those that gave way would take the places of others in the queue.
    if (job_) job_->Withdraw();
  }

  /// The first time and after each answer.
  void ReadRequest() {
    if (answered_any_) Note(Places::State::kIdle);
    incoming_.Next();
    stream_.expires_after(context_->limits.idle_wait);
    begun_ = false;
    Advance();
  }

 private:
  void Note(Places::State state) {
    if (place_) Places::Note(*place_, state, context_->server.clock.Steady());
  }

  void Advance() {
    const Incoming::Step step = incoming_.Advance();
    if (step == Incoming::Step::kNothing) return ReadMore();
    if (!std::exchange(begun_, true)) stream_.expires_after(context_->limits.request_wait);
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
    stream_.async_read_some(incoming_.Room(),
                            [self = shared_from_this()](beast::error_code error, std::size_t n) {
                              if (error) return;  // the peer is gone, or took too long
                              self->incoming_.Received(n);
                              self->Advance();
                            });
  }

  void SendContinue() {
    asio::async_write(stream_, asio::buffer(kContinue),
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        if (!error) self->Advance();
                      });
  }

  void OnRefused() {
    started_ = context_->server.clock.Steady();
    route_ = OtherRoute();
    method_ = MethodOf(incoming_.message().method());
    keep_alive_ = false;
    Answer(std::move(incoming_.refusal()));
  }

  /// A header that may stand there several times, as one (RFC 9110, 5.3).
  [[nodiscard]] std::string Listed(bhttp::field name) const {
    std::string all;
    const auto [first, last] = incoming_.message().equal_range(name);
    for (auto header = first; header != last; ++header) {
      if (!all.empty()) all += ", ";
      all += std::string_view(header->value().data(), header->value().size());
    }
    return all;
  }

  [[nodiscard]] Request ToRequest() const {
    const auto& message = incoming_.message();
    Request request{method_, std::string(message.target()), Listed(bhttp::field::accept),
                    Listed(bhttp::field::accept_encoding), Listed(bhttp::field::if_none_match)};
    const std::size_t hosts = message.count(bhttp::field::host);
    if (hosts == 1) request.host = std::string(message[bhttp::field::host]);
    request.host_required = version_ >= 11 || hosts > 1;
    if (message.count(bhttp::field::origin) > 0) {
      request.origin = std::string(message[bhttp::field::origin]);
    }
    request.fetch_site = std::string(message["Sec-Fetch-Site"]);
    request.monitoring_only = place_ && (*place_)->monitoring_only;
    request.listener = context_->listener;
    return request;
  }

  void OnRequest() {
    started_ = context_->server.clock.Steady();
    method_ = MethodOf(incoming_.message().method());
    version_ = incoming_.message().version();
    keep_alive_ = incoming_.keep_alive();
    Resolved resolved = context_->server.entrance.Resolve(ToRequest());
    Note(IsScrape(resolved.lane) ? Places::State::kScraping : Places::State::kBusy);
    route_ = resolved.route;
    if (resolved.lane == Lane::kIo) return Answer(resolved.run());

    stream_.expires_never();  // the answer's time is the store's
    job_ = PostedJob::Post(
        *context_, resolved.lane,
        [self = shared_from_this(), run = std::move(resolved.run)]() mutable {
          // A connection that has given way meanwhile needs no answer.
          Response response = self->gave_way_ ? Response() : run();
          // The reference moves along, so that the connection always ends on the loop's thread.
          asio::any_io_executor executor = self->stream_.get_executor();
          asio::post(executor, [moved = std::move(self), answer = std::move(response)]() mutable {
            moved->job_.reset();
            if (!moved->gave_way_) moved->Answer(std::move(answer));
          });
        });
    if (!job_) Answer(IsScrape(resolved.lane) ? TooManyScrapes() : TooBusy());
  }

  template <typename Body>
  bhttp::response<Body> Head(const Response& answer) const {
    bhttp::response<Body> message(bhttp::int_to_status(static_cast<unsigned>(answer.status)),
                                  version_);
    message.set(bhttp::field::date, ImfFixdate(context_->server.clock.System()));
    SetHeaders(answer, message);
    message.keep_alive(keep_alive_);
    if (keep_alive_) {
      message.set(bhttp::field::connection, "keep-alive");  // names the header, too
      message.set(bhttp::field::keep_alive, context_->keep_alive);
    }
    return message;
  }

  void Answer(Response answer) {
    if (answer.closes || (place_ && context_->places.Crowded(*place_))) keep_alive_ = false;
    answered_any_ = true;
    // A client that is refused because no place is free has no place to keep.
    Note(answer.closes ? Places::State::kIdle : Places::State::kAnswering);
    const auto took = context_->server.clock.Steady() - started_;
    context_->server.probe.request_seconds.Observe(std::chrono::duration<double>(took).count());
    context_->server.probe.CountRequest(route_, answer.status);
    const log::Logger& logger = context_->server.logger;
    if (logger.Enabled(log::Level::kDebug)) {
      const auto ms = std::chrono::duration_cast<milliseconds>(took).count();
      logger.Debug("http_answered",
                   {{"route", RouteName(route_)}, {"status", answer.status}, {"ms", ms}});
    }
    if (method_ == Method::kHead || answer.status == 304) {
      Send(answer_.emplace<HeadOnly>(Head<bhttp::empty_body>(answer)));
    } else if (answer.shared_body != nullptr) {
      auto& message = answer_.emplace<Shared>(Head<bhttp::span_body<const char>>(answer));
      message.body() = {answer.shared_body->data(), answer.shared_body->size()};
      shared_body_ = std::move(answer.shared_body);
      Send(message);
    } else {
      auto& message = answer_.emplace<Whole>(Head<bhttp::string_body>(answer));
      message.body() = std::move(answer.body);
      Send(message);
    }
  }

  template <typename Message>
  void Send(Message& message) {
    stream_.expires_after(context_->limits.answer_wait);
    bhttp::async_write(stream_, message,
                       [self = shared_from_this()](beast::error_code error, std::size_t) {
                         // Release a shared answer at once, even if the connection is kept.
                         self->answer_.emplace<std::monostate>();
                         self->shared_body_.reset();
                         if (error) return;
                         if (self->keep_alive_) return self->ReadRequest();
                         self->Close();
                       });
  }

  void Close() {
    Note(Places::State::kIdle);
    beast::error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream_.expires_after(kLingerWait);
    Linger();
  }

  void Linger() {
    stream_.async_read_some(asio::buffer(discard_),
                            [self = shared_from_this()](beast::error_code error, std::size_t n) {
                              self->lingered_ += n;
                              if (!error && self->lingered_ < kLingerBytesMax) self->Linger();
                            });
  }

  using Whole = bhttp::response<bhttp::string_body>;
  using HeadOnly = bhttp::response<bhttp::empty_body>;
  using Shared = bhttp::response<bhttp::span_body<const char>>;

  const std::shared_ptr<ConnectionContext> context_;
  /// That of the request, until the loop has its answer.
  std::optional<PostedJob> job_;
  /// Nothing once it gave way.
  std::optional<Places::Handle> place_;
  beast::tcp_stream stream_;
  /// Read by the thread that answers, too.
  std::atomic<bool> gave_way_{false};
  Incoming incoming_;
  /// Something of the request has come.
  bool begun_ = false;
  std::variant<std::monostate, Whole, HeadOnly, Shared> answer_;
  std::shared_ptr<const std::string> shared_body_;
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

void ServeConnection(const std::shared_ptr<ConnectionContext>& context, tcp::socket socket,
                     const Source& source) {
  std::make_shared<Connection>(context, std::move(socket), source)->ReadRequest();
}

}  // namespace uplink::http
