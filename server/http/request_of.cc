#include "server/http/request_of.h"

#include <string>
#include <string_view>
#include <utility>

#include <boost/beast/http/field.hpp>
#include <boost/beast/http/verb.hpp>

namespace uplink::http {
namespace {

namespace bhttp = boost::beast::http;
using Message = Incoming::Parser::value_type;

/// A header that may stand there several times, as one (RFC 9110, 5.3).
template <typename Name>
std::string Listed(const Message& message, Name name) {
  std::string all;
  const auto [first, last] = message.equal_range(name);
  for (auto header = first; header != last; ++header) {
    if (!all.empty()) all += ", ";
    all += std::string_view(header->value().data(), header->value().size());
  }
  return all;
}

void AddOrigin(const Message& message, const Peer& peer, bool trusted, Request& request) {
  const std::optional<Peer> other =
      trusted ? ForwardedFor(Listed(message, "X-Forwarded-For")) : std::nullopt;
  const Peer& from = other ? *other : peer;
  request.source = from.source;
  request.from = from.text;
}

}  // namespace

Method MethodOf(const Message& message) {
  if (message.method() == bhttp::verb::get) return Method::kGet;
  if (message.method() == bhttp::verb::head) return Method::kHead;
  if (message.method() == bhttp::verb::post) return Method::kPost;
  return Method::kOther;
}

Request RequestOf(const Message& message, const Peer& peer, bool trusted) {
  Request request{
      MethodOf(message), std::string(message.target()), Listed(message, bhttp::field::accept),
      Listed(message, bhttp::field::accept_encoding), Listed(message, bhttp::field::if_none_match)};
  const std::size_t hosts = message.count(bhttp::field::host);
  if (hosts == 1) request.host = std::string(message[bhttp::field::host]);
  request.host_required = message.version() >= 11 || hosts > 1;
  if (message.count(bhttp::field::origin) > 0) {
    request.origin = std::string(message[bhttp::field::origin]);
  }
  request.fetch_site = std::string(message["Sec-Fetch-Site"]);
  if (message.count(bhttp::field::authorization) > 0) {
    request.authorization = Listed(message, bhttp::field::authorization);
  }
  if (request.method == Method::kPost) {
    request.content_type = Listed(message, bhttp::field::content_type);
    request.body = message.body();
  }
  AddOrigin(message, peer, trusted, request);
  return request;
}

}  // namespace uplink::http
