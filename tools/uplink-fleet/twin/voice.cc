#include "tools/uplink-fleet/twin/voice.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "schema/base/check.h"
#include "schema/json/exact.h"
#include "tools/uplink-fleet/twin/canonical.h"
#include "tools/uplink-fleet/twin/filling.h"

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
  FillTexts(*fields, chance_, [&](const std::string& text) {
    return Replaced(WithIds(text), "{mark}", MarkOf(draft));
  });
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
