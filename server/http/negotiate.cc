#include "server/http/negotiate.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "server/http/header_text.h"

namespace uplink::http {
namespace {

/// Items of a header that are looked at.
constexpr std::size_t kItemsMax = 32;

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// The part before the first `separator`, trimmed; `text` keeps what comes after it.
std::string_view Next(std::string_view& text, char separator) {
  const std::size_t at = std::min(text.find(separator), text.size());
  const std::string_view part = Trimmed(text.substr(0, at));
  text.remove_prefix(std::min(at + 1, text.size()));
  return part;
}

/// 0 to 1; 0 for what is no number.
double QualityOf(std::string_view text) {
  double quality = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), quality);
  const bool whole = read.ec == std::errc() && read.ptr == text.data() + text.size();
  return whole && quality >= 0 && quality <= 1 ? quality : 0;
}

/// One item of a header: what it names, how much it is liked, and its version if it names one.
struct Item {
  std::string_view name;
  double quality = 1;
  std::string_view version;
};

Item ItemOf(std::string_view text) {
  Item item{.name = Next(text, ';')};
  while (!text.empty()) {
    std::string_view parameter = Next(text, ';');
    const std::string_view name = Next(parameter, '=');
    if (SameWord(name, "q")) item.quality = QualityOf(Trimmed(parameter));
    if (SameWord(name, "version")) item.version = Trimmed(parameter);
  }
  return item;
}

template <typename Take>
void ForEachItem(std::string_view header, Take take) {
  for (std::size_t i = 0; i < kItemsMax && !header.empty(); ++i) take(ItemOf(Next(header, ',')));
}

}  // namespace

metrics::Format FormatFor(std::string_view accept) {
  double open_metrics = 0;
  double text = 0;
  ForEachItem(accept, [&](const Item& item) {
    if (SameWord(item.name, "application/openmetrics-text")) {
      const bool ours = item.version.empty() || item.version == "1.0.0";
      if (ours) open_metrics = std::max(open_metrics, item.quality);
    } else if (SameWord(item.name, "text/plain")) {
      text = std::max(text, item.quality);
    }
  });
  return open_metrics > 0 && open_metrics >= text ? metrics::Format::kOpenMetrics
                                                  : metrics::Format::kText;
}

bool PrefersLines(std::string_view accept) {
  double lines = 0;
  double json = 0;
  ForEachItem(accept, [&](const Item& item) {
    if (SameWord(item.name, "application/x-ndjson")) lines = std::max(lines, item.quality);
    if (SameWord(item.name, "application/json")) json = std::max(json, item.quality);
  });
  return lines > 0 && lines >= json;
}

metrics::Coding CodingFor(std::string_view accept_encoding) {
  std::optional<double> gzip;
  double any = 0;
  ForEachItem(accept_encoding, [&](const Item& item) {
    if (SameWord(item.name, "gzip") || SameWord(item.name, "x-gzip")) gzip = item.quality;
    if (item.name == "*") any = item.quality;
  });
  return gzip.value_or(any) > 0 ? metrics::Coding::kGzip : metrics::Coding::kPlain;
}

}  // namespace uplink::http
