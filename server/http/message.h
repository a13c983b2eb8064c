#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/http/credentials.h"
#include "server/http/listeners.h"
#include "server/http/source.h"
#include "server/identity/caller.h"

namespace uplink::http {

/// The methods of requests that we distinguish.
enum class Method : std::uint8_t { kGet, kHead, kPost, kOther };

/// A request as handlers see it. A value.
struct Request {
  Method method = Method::kGet;
  /// Path and query as they came: `/api/v1/robots?fleet=a`; or the whole address (absolute-form).
  std::string target;
  /// The headers Accept and Accept-Encoding; empty: none.
  std::string accept{};
  std::string accept_encoding{};
  /// The header If-None-Match; empty: none.
  std::string if_none_match{};
  /// The header Host; nothing: there is none, or there are several.
  std::optional<std::string> host{};
  /// The header Origin; nothing: there is none.
  std::optional<std::string> origin{};
  /// The header Sec-Fetch-Site; empty: none.
  std::string fetch_site{};
  /// The request must have one Host header: it is of HTTP/1.1, or has several.
  bool host_required = false;
  /// The header Authorization; nothing: there is none.
  std::optional<std::string> authorization{};
  /// Of POST: the header Content-Type, and the body; a body of others is never looked at.
  std::string content_type{};
  std::string body{};
  /// Null: the connection has shown none.
  std::shared_ptr<const PeerCertificate> certificate{};
  /// Where it comes from: the connection's peer, or the one for whom that says to ask.
  Source source{};
  /// The same for the log.
  std::string from = "unknown";
  /// The connection is kept for probes and scrapes.
  bool monitoring_only = false;
  /// Where it came in.
  ListenerId listener = ListenerId::kHttp;
  /// Its caller must show who it is, however open the rest of the server is.
  bool proves = false;
  /// Who asks.
  identity::Caller caller = identity::LocalCaller();
};

inline constexpr std::string_view kJson = "application/json";

/// An answer. A value.
struct Response {
  int status = 200;
  std::string_view content_type = kJson;
  std::string body;
  /// Value of the Allow header; empty: none.
  std::string_view allow{};
  /// In place of `body`, if set: a text that others may hold too.
  std::shared_ptr<const std::string> shared_body{};
  /// How the body is carried: `gzip`; empty: as it is.
  std::string_view coding{};
  /// The answer depends on Accept and Accept-Encoding.
  bool varies = false;
  /// Value of the ETag header; empty: clients need not keep the answer.
  std::string entity_tag{};
  /// Of a list that goes as lines: what the next page begins behind; empty: this is the last one.
  std::string next_page_token{};
  /// Value of the WWW-Authenticate header; empty: none.
  std::string_view authenticate{};
  /// Value of the Retry-After header; zero: that of every 503, or none.
  std::chrono::seconds retry_after{0};
  /// The connection ends after it.
  bool closes = false;
  /// Of an error: the canonical name, such as NOT_FOUND, and the sentence that the body has.
  std::string_view code{};
  std::string why{};
  /// What really failed, for the log alone.
  std::string cause{};

  [[nodiscard]] std::string_view content() const {
    return shared_body != nullptr ? std::string_view(*shared_body) : std::string_view(body);
  }
};

}  // namespace uplink::http
