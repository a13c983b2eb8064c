#pragma once

#include <memory>
#include <string>
#include <utility>
#include <variant>

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>

#include "schema/base/clock.h"
#include "server/http/answer_head.h"
#include "server/http/header_text.h"
#include "server/http/message.h"
#include "server/http/wire.h"

namespace uplink::http {

/// An answer that is on its way to its peer. Confined to its connection.
class SentAnswer final {
 public:
  struct Form {
    unsigned version = 11;
    /// To HEAD, or without a body.
    bool head_only = false;
    bool keep_alive = false;
    /// The value of Keep-Alive.
    const std::string& keep_alive_text;
    SystemTime now{};
  };

  /// `handler` runs once the wire has taken it all, or has failed; call Clear then.
  template <typename Handler>
  void Write(Wire& wire, Response answer, const Form& form, Handler handler) {
    namespace bhttp = boost::beast::http;
    if (form.head_only) {
      auto& message = answer_.emplace<HeadOnly>(Head<bhttp::empty_body>(answer, form));
      bhttp::async_write(wire, message, std::move(handler));
    } else if (answer.shared_body != nullptr) {
      auto& message = answer_.emplace<Shared>(Head<bhttp::span_body<const char>>(answer, form));
      message.body() = {answer.shared_body->data(), answer.shared_body->size()};
      shared_body_ = std::move(answer.shared_body);
      bhttp::async_write(wire, message, std::move(handler));
    } else {
      auto& message = answer_.emplace<Whole>(Head<bhttp::string_body>(answer, form));
      message.body() = std::move(answer.body);
      bhttp::async_write(wire, message, std::move(handler));
    }
  }
  /// Releases what it holds, a shared answer above all.
  void Clear() {
    answer_.emplace<std::monostate>();
    shared_body_.reset();
  }

 private:
  using Whole = boost::beast::http::response<boost::beast::http::string_body>;
  using HeadOnly = boost::beast::http::response<boost::beast::http::empty_body>;
  using Shared = boost::beast::http::response<boost::beast::http::span_body<const char>>;

  template <typename Body>
  [[nodiscard]] static boost::beast::http::response<Body> Head(const Response& answer,
                                                               const Form& form) {
    namespace bhttp = boost::beast::http;
    bhttp::response<Body> message(bhttp::int_to_status(static_cast<unsigned>(answer.status)),
                                  form.version);
    message.set(bhttp::field::date, ImfFixdate(form.now));
    SetHeaders(answer, message);
    message.keep_alive(form.keep_alive);
    if (form.keep_alive) {
      message.set(bhttp::field::connection, "keep-alive");  // names the header, too
      message.set(bhttp::field::keep_alive, form.keep_alive_text);
    }
    return message;
  }

  std::variant<std::monostate, Whole, HeadOnly, Shared> answer_;
  std::shared_ptr<const std::string> shared_body_;
};

}  // namespace uplink::http
