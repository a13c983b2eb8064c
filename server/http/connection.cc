#include "server/http/connection.h"

#include <array>
#include <atomic>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include <boost/asio/post.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>

#include "server/http/errors.h"

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

Method MethodOf(bhttp::verb verb) {
  if (verb == bhttp::verb::get) return Method::kGet;
  if (verb == bhttp::verb::head) return Method::kHead;
  return Method::kOther;
}

class Connection final : public PlaceHolder, public std::enable_shared_from_this<Connection> {
 public:
  Connection(std::shared_ptr<ConnectionContext> context, tcp::socket socket)
      : context_(std::move(context)), stream_(std::move(socket)) {
    place_ = context_->places.Take(*this, context_->server.clock.Steady());
    context_->server.probe.connections.Add(1);
  }
  ~Connection() override {
    if (place_) context_->places.Leave(*place_);
    context_->server.probe.connections.Add(-1);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void GiveWay() override {
    place_.reset();
    gave_way_ = true;
    stream_.close();
  }

  /// The first time and after each answer.
  void ReadRequest() {
    if (answered_any_) Note(Places::State::kIdle);
    parser_.emplace();
    parser_->header_limit(kHeaderBytesMax);
    parser_->body_limit(kBodyBytesMax);
    stream_.expires_after(context_->request_wait);
    bhttp::async_read(stream_, buffer_, *parser_,
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        if (error) {
                          self->OnReadFailed(error);
                        } else {
                          self->OnRequest();
                        }
                      });
  }

 private:
  void Note(Places::State state) {
    if (place_) Places::Note(*place_, state, context_->server.clock.Steady());
  }

  [[nodiscard]] Request ToRequest() const {
    const auto& message = parser_->get();
    Request request{method_, std::string(message.target()),
                    std::string(message[bhttp::field::accept]),
                    std::string(message[bhttp::field::accept_encoding])};
    const std::size_t hosts = message.count(bhttp::field::host);
    if (hosts == 1) request.host = std::string(message[bhttp::field::host]);
    request.host_required = version_ >= 11 || hosts > 1;
    request.monitoring_only = place_ && (*place_)->monitoring_only;
    return request;
  }

  [[nodiscard]] ReadThread& ThreadOf(Lane lane) const {
    switch (lane) {
      case Lane::kMemory:
        return context_->server.memory;
      case Lane::kMetrics:
        return context_->server.metrics;
      case Lane::kScrape:
        return context_->server.scrapes;
      case Lane::kIo:
      case Lane::kRead:
        break;
    }
    return context_->server.reads;
  }

  void OnRequest() {
    started_ = context_->server.clock.Steady();
    method_ = MethodOf(parser_->get().method());
    version_ = parser_->get().version();
    keep_alive_ = parser_->get().keep_alive();
    Resolved resolved = context_->server.entrance.Resolve(ToRequest());
    Note(IsScrape(resolved.lane) ? Places::State::kScraping : Places::State::kBusy);
    route_ = resolved.route;
    if (resolved.lane == Lane::kIo) return Answer(resolved.run());
    ReadThread& thread = ThreadOf(resolved.lane);

    stream_.expires_never();  // the answer's time is the store's
    const bool taken =
        thread.TryPost([self = shared_from_this(), run = std::move(resolved.run)]() mutable {
          // For whom has given way meanwhile nothing is written.
          Response response = self->gave_way_ ? Response() : run();
          // The reference moves along, so that the connection always ends on the loop's thread.
          asio::any_io_executor executor = self->stream_.get_executor();
          asio::post(executor, [moved = std::move(self), answer = std::move(response)]() mutable {
            if (!moved->gave_way_) moved->Answer(std::move(answer));
          });
        });
    if (!taken) Answer(TooBusy());
  }

  void OnReadFailed(const beast::error_code& error) {
    started_ = context_->server.clock.Steady();
    route_ = OtherRoute();
    method_ = Method::kGet;
    keep_alive_ = false;
    if (error == bhttp::error::header_limit) {
      return Answer(BadRequest(431, "the request's headers are too large"));
    }
    if (error == bhttp::error::body_limit) {
      return Answer(BadRequest(413, "the request's body is too large"));
    }
    const bool not_http =
        error.category() == bhttp::make_error_code(bhttp::error::bad_method).category() &&
        error != bhttp::error::end_of_stream && error != bhttp::error::partial_message;
    if (not_http) return Answer(BadRequest(400, error.message()));
    // The peer is gone, or took too long.
  }

  template <typename Body>
  bhttp::response<Body> Head(const Response& answer) const {
    bhttp::response<Body> message(bhttp::int_to_status(static_cast<unsigned>(answer.status)),
                                  version_);
    message.set(bhttp::field::content_type,
                beast::string_view(answer.content_type.data(), answer.content_type.size()));
    message.set(bhttp::field::cache_control, "no-store");
    message.set("X-Content-Type-Options", "nosniff");
    if (!answer.allow.empty()) {
      message.set(bhttp::field::allow,
                  beast::string_view(answer.allow.data(), answer.allow.size()));
    }
    if (!answer.coding.empty()) {
      message.set(bhttp::field::content_encoding,
                  beast::string_view(answer.coding.data(), answer.coding.size()));
    }
    if (answer.varies) message.set(bhttp::field::vary, "Accept, Accept-Encoding");
    message.keep_alive(keep_alive_);
    message.content_length(answer.content().size());
    return message;
  }

  void Answer(Response answer) {
    if (answer.closes) keep_alive_ = false;
    answered_any_ = true;
    // Who is refused for want of a place has none to keep.
    Note(answer.closes ? Places::State::kIdle : Places::State::kAnswering);
    const auto took = context_->server.clock.Steady() - started_;
    context_->server.probe.request_seconds.Observe(std::chrono::duration<double>(took).count());
    context_->server.probe.CountRequest(route_, answer.status);
    if (method_ == Method::kHead) {
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
    stream_.expires_after(kAnswerWait);
    bhttp::async_write(stream_, message,
                       [self = shared_from_this()](beast::error_code error, std::size_t) {
                         // What was shared is given back at once, whoever keeps the connection.
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
  /// Nothing once it gave way.
  std::optional<Places::Handle> place_;
  beast::tcp_stream stream_;
  /// Read by the thread that answers, too.
  std::atomic<bool> gave_way_{false};
  beast::flat_buffer buffer_{kSentAheadBytesMax};
  std::optional<bhttp::request_parser<bhttp::string_body>> parser_;
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

void ServeConnection(const std::shared_ptr<ConnectionContext>& context, tcp::socket socket) {
  std::make_shared<Connection>(context, std::move(socket))->ReadRequest();
}

}  // namespace uplink::http
