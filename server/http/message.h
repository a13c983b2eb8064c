#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace uplink::http {

/// The method of a request, as far as we tell them apart.
enum class Method : std::uint8_t { kGet, kHead, kOther };

/// A request as handlers see it; a body is never looked at. A value.
struct Request {
  Method method = Method::kGet;
  /// Path and query as they came: `/api/v1/robots?fleet=a`.
  std::string target;
};

inline constexpr std::string_view kJson = "application/json";

/// An answer. A value.
struct Response {
  int status = 200;
  std::string_view content_type = kJson;
  std::string body;
  /// Value of the Allow header; empty: none.
  std::string_view allow{};
};

}  // namespace uplink::http
