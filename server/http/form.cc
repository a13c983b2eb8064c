#include "server/http/form.h"

#include <optional>
#include <string>
#include <utility>

#include "metrics/gzip.h"
#include "server/http/entity_tag.h"
#include "server/http/row_lines.h"

namespace uplink::http {
namespace {

constexpr std::string_view kLines = "application/x-ndjson";

void MakeLines(Response& answer) {
  if (answer.content_type != kJson) return;
  std::optional<RowLines> lines = LinesOfList(answer.body);
  if (!lines) return;
  answer.content_type = kLines;
  answer.body = std::move(lines->text);
  answer.next_page_token = std::move(lines->next_page_token);
}

/// What a client keeps stays as it has it: a 304 tells the headers, and has no body.
void MakeNotModified(Response& answer) {
  answer.status = 304;
  answer.body.clear();
}

void MakeGzip(Response& answer) {
  std::string zipped;
  metrics::Gzip(answer.body, zipped);
  answer.body = std::move(zipped);
  answer.coding = "gzip";
}

}  // namespace

Response InFormOf(const RoutedRequest& request, const Route& route, Response answer) {
  if (request.form == view::Form::kWire) return answer;
  if (answer.events != nullptr) return answer;
  answer.varies = true;
  const bool found = answer.status == 200;
  if (found && request.lines) MakeLines(answer);
  if (found && route.tagged) {
    answer.entity_tag = EntityTag(answer.body);
    if (NamesTag(request.if_none_match, answer.entity_tag)) MakeNotModified(answer);
  }
  const bool large = answer.body.size() >= kGzipBytesMin;
  if (large && request.coding == metrics::Coding::kGzip) MakeGzip(answer);
  return answer;
}

}  // namespace uplink::http
