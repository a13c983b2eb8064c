#include "schema/cyberwave/head.h"

#include <cstddef>

#include "schema/limits.h"

namespace uplink::cyberwave {
namespace {

using model::cyberwave::Head;
using model::cyberwave::SourceType;

constexpr std::string_view kSimulated = "_sim_";
constexpr std::string_view kReal = "_live_";
constexpr std::string_view kHexDigits = "0123456789abcdefABCDEF";

/// Where `mark` stands last with a number in hex behind it, which ends the text or at a `_`; npos
/// if nowhere.
std::size_t LastMark(std::string_view text, std::string_view mark) {
  std::size_t at = text.rfind(mark);
  while (at != std::string_view::npos && at > 0) {
    const std::size_t digits = at + mark.size();
    const std::size_t end = text.find_first_not_of(kHexDigits, digits);
    const bool any = end == std::string_view::npos ? digits < text.size() : digits < end;
    if (any && (end == std::string_view::npos || text[end] == '_')) return at;
    at = text.rfind(mark, at - 1);
  }
  return std::string_view::npos;
}

std::string_view StringIn(const Reader& in, std::string_view name) {
  const boost::json::value* value = in.Find(name);
  if (value == nullptr || !value->is_string()) return {};
  return FromBoost(value->get_string());
}

}  // namespace

bool IsSimulatedSession(std::string_view session_id) {
  const std::size_t simulated = LastMark(session_id, kSimulated);
  if (simulated == std::string_view::npos) return false;
  const std::size_t real = LastMark(session_id, kReal);
  return real == std::string_view::npos || simulated > real;
}

SourceType SourceTypeOf(const Reader& in) {
  const std::string_view word = StringIn(in, "source_type");
  if (!word.empty()) return model::cyberwave::SourceTypeFromText(word);
  return IsSimulatedSession(StringIn(in, "session_id")) ? SourceType::kSim : SourceType::kEdge;
}

Head ReadHead(Reader& in, SourceType type, double enclosed_seconds) {
  Head head;
  head.source.type = type;
  head.source.text = in.Text("source_type", schema::kNameBytesMax);
  // A word that is not fit to keep says nothing.
  if (type == SourceType::kUnknown && head.source.text.empty())
    head.source.type = SourceType::kEdge;
  head.session_id = in.Text("session_id", schema::kIdBytesMax);
  const bool own = in.Find("timestamp") != nullptr || in.Find("ts") != nullptr;
  if (own) {
    head.timestamp_us = in.TimeUs(in.Find("timestamp") != nullptr ? "timestamp" : "ts");
  } else if (enclosed_seconds != 0) {
    head.timestamp_us = TimeUsOf(in.violations(), enclosed_seconds);
  }
  return head;
}

}  // namespace uplink::cyberwave
