#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <boost/asio/buffer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include "server/http/limits.h"
#include "server/http/message.h"

namespace uplink::http {

/// What a connection has received, and the request that is read from it now. Holds no socket.
/// Confined to its connection.
class Incoming final {
 public:
  explicit Incoming(const ListenerLimits& limits) : limits_(limits) {}

  using Parser = boost::beast::http::request_parser<boost::beast::http::string_body>;

  /// Begins the next request, with what came of it already.
  void Next();

  /// Where bytes are received, one at least; Received says how many came.
  [[nodiscard]] boost::asio::mutable_buffer Room();
  void Received(std::size_t bytes) { buffer_.commit(bytes); }

  /// How far the request is. Read more after kNothing and kPart.
  enum class Step : std::uint8_t {
    /// Nothing of it came: an empty line before it at most, which is skipped (RFC 9112, 2.2).
    kNothing,
    kPart,
    /// Its peer waits for `100 Continue` before it sends the body; told once.
    kExpects,
    kWhole,
    /// It is no request as we take it: answer `refusal`, and end the connection.
    kRefused,
  };
  [[nodiscard]] Step Advance();

  /// After kExpects, kWhole and kRefused; what was refused may lack parts.
  [[nodiscard]] const Parser::value_type& message() const { return parser_->get(); }
  [[nodiscard]] bool keep_alive() const { return parser_->keep_alive(); }
  /// After kRefused.
  [[nodiscard]] Response& refusal() { return refusal_; }

 private:
  [[nodiscard]] std::string_view Bytes() const;
  [[nodiscard]] bool Begins();
  [[nodiscard]] Step TakeHead();
  /// Judges the head, whose bytes these are.
  [[nodiscard]] Step JudgeHead(std::string_view head);
  [[nodiscard]] Step TakeBody();
  [[nodiscard]] Step Refuse(int status, std::string_view what);

  const ListenerLimits limits_;
  boost::beast::flat_buffer buffer_{limits_.header_bytes_max + limits_.body_bytes_max};
  std::optional<Parser> parser_;
  /// What the parser took of the head, which the buffer still has.
  std::size_t parsed_ = 0;
  bool empty_line_skipped_ = false;
  bool begun_ = false;
  bool head_taken_ = false;
  Response refusal_;
};

}  // namespace uplink::http
