#include "tools/uplink-fleet/twin/voice.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

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

void Voice::SetNow(std::int64_t now_us) { now_us_ = std::max(now_us, now_us_ + 1); }

Draft Voice::BeginBare() {
  SetNow(now_us_);
  Draft draft;
  draft.number = ++last_number_;
  draft.time_us = now_us_;
  return draft;
}

Draft Voice::Begin(Speaker speaker, std::string_view source) {
  Draft draft = BeginBare();
  if (!source.empty()) draft.body["source_type"] = JsonText(source);
  draft.body["timestamp"] = SecondsOf(draft.time_us);
  if (const std::string* session = SessionOf(speaker, ids_)) draft.body["session_id"] = *session;
  return draft;
}

Draft Voice::BeginLate(Speaker speaker, std::string_view source) {
  Draft draft = Begin(speaker, source);
  draft.time_us -= kLateUs;
  draft.body["timestamp"] = SecondsOf(draft.time_us);
  return draft;
}

Publication Voice::To(const std::string& path, const Draft& draft, Qos qos) const {
  return {.number = draft.number,
          .topic = Topic(path),
          .payload = js::serialize(draft.body),
          .qos = qos,
          .retain = false};
}

Publication Voice::ToTwin(const Draft& draft, std::string_view tail, Qos qos) const {
  return To(fmt::format("twin/{}/{}", ids_.twin, tail), draft, qos);
}

Publication Voice::ToJoints(const Draft& draft) const {
  return To(fmt::format("joint/{}/update", ids_.twin), draft, Qos::k0);
}

js::object AsShown(const Draft& draft, js::object fields, std::string_view source) {
  fields["source_type"] = JsonText(source);
  if (draft.body.contains("timestamp")) fields["timestamp"] = SecondsOf(draft.time_us);
  return fields;
}

}  // namespace uplink::synthetic
