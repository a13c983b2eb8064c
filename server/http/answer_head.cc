#include "server/http/answer_head.h"

#include <string>
#include <string_view>

#include <boost/beast/core/string_type.hpp>

#include "server/http/limits.h"

namespace uplink::http {
namespace {

namespace beast = boost::beast;
using Field = beast::http::field;

/// Where a list goes as lines, its body has rows alone.
constexpr const char* kNextPageToken = "Uplink-Next-Page-Token";

beast::string_view ToBeast(std::string_view text) { return {text.data(), text.size()}; }

}  // namespace

void SetHeaders(const Response& answer, beast::http::fields& head) {
  // A 304 has neither body nor length: what the client keeps stays as it is.
  if (answer.status != 304) {
    head.set(Field::content_type, ToBeast(answer.content_type));
    head.set(Field::content_length, std::to_string(answer.content().size()));
  }
  head.set(Field::cache_control, answer.entity_tag.empty() ? "no-store" : "private, no-cache");
  head.set("X-Content-Type-Options", "nosniff");
  if (!answer.allow.empty()) head.set(Field::allow, ToBeast(answer.allow));
  if (!answer.coding.empty()) head.set(Field::content_encoding, ToBeast(answer.coding));
  if (answer.varies) head.set(Field::vary, "Accept, Accept-Encoding");
  if (!answer.entity_tag.empty()) head.set(Field::etag, answer.entity_tag);
  if (!answer.next_page_token.empty()) head.set(kNextPageToken, answer.next_page_token);
  if (!answer.authenticate.empty()) head.set(Field::www_authenticate, ToBeast(answer.authenticate));
  if (answer.retry_after.count() > 0) {
    head.set(Field::retry_after, std::to_string(answer.retry_after.count()));
  } else if (answer.status == 503) {
    head.set(Field::retry_after, std::to_string(kRetryAfter.count()));
  }
}

}  // namespace uplink::http
