#include "tools/uplink-fleet/twin/voice.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "schema/base/check.h"
#include "schema/json/exact.h"
#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

/// Apart from what decides a twin's ids.
constexpr std::uint64_t kScriptSalt = 0x7477'696e'5f73'6179ULL;

const std::string* SessionOf(Speaker speaker, const TwinIds& ids) {
  switch (speaker) {
    case Speaker::kDriver:
      return &ids.driver_session;
    case Speaker::kSimulation:
      return &ids.sim_session;
    case Speaker::kViewer:
      return &ids.viewer_session;
    case Speaker::kNone:
      return nullptr;
  }
  return nullptr;
}

std::string Replaced(std::string text, std::string_view token, std::string_view with) {
  for (std::size_t at = text.find(token); at != std::string::npos; at = text.find(token, at)) {
    text.replace(at, token.size(), with);
    at += with.size();
  }
  return text;
}

std::optional<double> NumberOf(std::string_view text) {
  double number = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = read.ec == std::errc() && read.ptr == text.data() + text.size();
  return whole ? std::optional(number) : std::nullopt;
}

/// A number drawn as `LOW..HIGH` or `LOW..HIGH#` says; nothing for another text.
std::optional<js::value> Drawn(std::string_view text, Seeded& chance) {
  const std::size_t dots = text.find("..");
  if (dots == std::string_view::npos) return std::nullopt;
  const bool whole = text.ends_with('#');
  const auto low = NumberOf(text.substr(0, dots));
  const auto high = NumberOf(text.substr(dots + 2, text.size() - dots - 2 - (whole ? 1 : 0)));
  if (!low || !high) return std::nullopt;
  if (!whole) return js::value(chance.Between(*low, *high));
  const auto count = static_cast<std::size_t>(*high - *low) + 1;
  return js::value(static_cast<std::int64_t>(*low) +
                   static_cast<std::int64_t>(chance.Below(count)));
}

/// One of the texts between bars.
std::string_view OneOf(std::string_view text, Seeded& chance) {
  std::vector<std::string_view> texts;
  for (std::size_t bar = text.find('|'); bar != std::string_view::npos; bar = text.find('|')) {
    texts.push_back(text.substr(0, bar));
    text.remove_prefix(bar + 1);
  }
  if (texts.empty()) return text;
  texts.push_back(text);
  return texts[chance.Below(texts.size())];
}

}  // namespace

Voice::Voice(const TwinOptions& options)
    : options_(options),
      ids_(IdsOf(options)),
      chance_(Seeded(options.seed ^ kScriptSalt).Next() + options.index) {}

void Voice::SetNow(std::int64_t now_us) { now_us_ = std::max(now_us, now_us_ + 1); }

std::string Voice::WithIds(std::string_view text) const {
  std::string filled(text);
  for (const auto& [token, id] :
       {std::pair("{twin}", &ids_.twin), std::pair("{computer}", &ids_.computer),
        std::pair("{environment}", &ids_.environment), std::pair("{run}", &ids_.workflow_run)}) {
    filled = Replaced(std::move(filled), token, *id);
  }
  return filled;
}

std::string Voice::Topic(std::string_view path) const {
  return options_.prefix + "cyberwave/" + WithIds(path);
}

js::value Voice::Filled(std::string_view text, const Draft& draft) {
  if (auto number = Drawn(text, chance_)) return *std::move(number);
  return js::value(JsonText(Replaced(WithIds(OneOf(text, chance_)), "{mark}", MarkOf(draft))));
}

// NOLINTNEXTLINE(misc-no-recursion): the depth is that of this program's own tables
void Voice::Fill(js::value& value, const Draft& draft) {
  if (js::object* object = value.if_object()) {
    for (auto& member : *object) Fill(member.value(), draft);
  } else if (js::array* items = value.if_array()) {
    for (js::value& item : *items) Fill(item, draft);
  } else if (const js::string* text = value.if_string()) {
    value = Filled({text->data(), text->size()}, draft);
  }
}

Draft Voice::BeginBare() {
  SetNow(now_us_);
  Draft draft;
  draft.number = ++last_number_;
  draft.time_us = now_us_;
  return draft;
}

Draft Voice::Begin(const Words& words) {
  Draft draft = BeginBare();
  if (words.head == Head::kLate) draft.time_us -= kLateUs;
  std::optional<js::value> fields = json::ParseExact(words.body);
  UPLINK_CHECK(fields && fields->is_object(), "the words of a table are an object of JSON");
  Fill(*fields, draft);
  draft.fields = std::move(fields->get_object());
  draft.body = draft.fields;
  if (words.head == Head::kNone) return draft;
  if (!words.source.empty()) draft.body["source_type"] = JsonText(words.source);
  if (words.head != Head::kTimeless) draft.body["timestamp"] = SecondsOf(draft.time_us);
  if (const std::string* session = SessionOf(words.speaker, ids_)) {
    draft.body["session_id"] = *session;
  }
  return draft;
}

Publication Voice::To(const Words& words, const Draft& draft, Qos qos) const {
  return {.number = draft.number,
          .topic = Topic(words.topic),
          .payload = js::serialize(draft.body),
          .qos = qos,
          .retain = false};
}

}  // namespace uplink::synthetic
