#include "server/http/incoming.h"

#include <boost/beast/core/error.hpp>
#include <boost/beast/core/read_size.hpp>
#include <boost/beast/core/string.hpp>

#include "server/http/errors.h"

namespace uplink::http {
namespace {

namespace beast = boost::beast;
namespace bhttp = boost::beast::http;

/// The most that one read takes.
constexpr std::size_t kReadBytesMax = 8UL * 1024;

bool HasFoldedLine(std::string_view head) {
  return head.find("\r\n ") != std::string_view::npos ||
         head.find("\r\n\t") != std::string_view::npos;
}

}  // namespace

void Incoming::Next() {
  parser_.emplace();
  parser_->header_limit(static_cast<std::uint32_t>(limits_.header_bytes_max));
  parser_->body_limit(boost::none);  // JudgeHead knows the length
  parsed_ = 0;
  empty_line_skipped_ = begun_ = head_taken_ = false;
}

boost::asio::mutable_buffer Incoming::Room() {
  return buffer_.prepare(beast::read_size(buffer_, kReadBytesMax));
}

Incoming::Step Incoming::Advance() {
  if (!begun_ && !Begins()) return Step::kNothing;
  return head_taken_ ? TakeBody() : TakeHead();
}

std::string_view Incoming::Bytes() const {
  return {static_cast<const char*>(buffer_.data().data()), buffer_.size()};
}

bool Incoming::Begins() {
  if (!empty_line_skipped_ && Bytes().starts_with("\r\n")) {
    buffer_.consume(2);
    empty_line_skipped_ = true;
  }
  const bool half_a_line = !empty_line_skipped_ && Bytes() == "\r";
  begun_ = !Bytes().empty() && !half_a_line;
  return begun_;
}

Incoming::Step Incoming::TakeHead() {
  // Its bytes stay in the buffer until it is whole: the parser joins what is folded.
  beast::error_code error;
  parsed_ += parser_->put(buffer_.data() + parsed_, error);
  const bool whole = parser_->is_header_done();
  if (error == bhttp::error::header_limit ||
      (whole ? parsed_ > limits_.header_bytes_max : buffer_.size() >= limits_.header_bytes_max)) {
    return Refuse(431, "the request's headers are too large");
  }
  if (error && error != bhttp::error::need_more) return Refuse(400, error.message());
  if (!whole) return Step::kPart;
  const Step step = JudgeHead(Bytes().substr(0, parsed_));
  buffer_.consume(parsed_);
  head_taken_ = true;
  return step == Step::kPart ? TakeBody() : step;
}

Incoming::Step Incoming::JudgeHead(std::string_view head) {
  if (HasFoldedLine(head)) return Refuse(400, "a header goes on in a further line");
  if (message().count(bhttp::field::transfer_encoding) > 0) {
    return Refuse(400, "Transfer-Encoding is not taken: give the body's Content-Length");
  }
  const std::uint64_t length = parser_->content_length().value_or(0);
  if (length > limits_.body_bytes_max) return Refuse(413, "the request's body is too large");
  const bool expects = message().version() >= 11 && length > 0 &&
                       beast::iequals(message()[bhttp::field::expect], "100-continue");
  // A peer that sends its body already waits for nothing.
  return expects && head.size() == buffer_.size() ? Step::kExpects : Step::kPart;
}

Incoming::Step Incoming::TakeBody() {
  beast::error_code error;
  if (!parser_->is_done() && buffer_.size() > 0) {
    buffer_.consume(parser_->put(buffer_.data(), error));
  }
  if (error && error != bhttp::error::need_more) return Refuse(400, error.message());
  return parser_->is_done() ? Step::kWhole : Step::kPart;
}

Incoming::Step Incoming::Refuse(int status, std::string_view what) {
  refusal_ = BadRequest(status, what);
  return Step::kRefused;
}

}  // namespace uplink::http
