#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "schema/model/capabilities.h"
#include "schema/model/health.h"
#include "schema/model/mission.h"
#include "schema/model/rcan.h"
#include "schema/model/reports.h"
#include "schema/model/spatial.h"

/// What the stores keep as JSON text: an object by the specification's names, rendered as in
/// render.h. No whitespace; UTF-8. Pure; any thread.
namespace uplink::json {

/// What the event's union member holds: `{}` for the e-stop kinds, a named event's detail as it is.
[[nodiscard]] std::string DetailText(const model::EventKind& kind);
[[nodiscard]] std::string Text(const model::MissionRunStatus& body);
[[nodiscard]] std::string Text(const model::UiCapabilities& body);
/// Key to value.
[[nodiscard]] std::string Text(const model::CurrentSettings& body);
[[nodiscard]] std::string Text(const model::AgentInfo& body);
[[nodiscard]] std::string Text(const model::Pose& pose);
[[nodiscard]] std::string Text(const model::Trajectory& trajectory);
/// A Robot State as RCAN spells it.
[[nodiscard]] std::string Text(const model::RcanState& state, std::string_view ruri);
/// An array of texts, each well-formed UTF-8.
[[nodiscard]] std::string ArrayText(std::span<const std::string> texts);
/// An object of texts, each well-formed UTF-8.
[[nodiscard]] std::string TextsText(const std::map<std::string, std::string>& texts);
/// The same again; members that are no texts are left out.
[[nodiscard]] std::map<std::string, std::string> TextsIn(std::string_view text);
/// A number that such a text holds at its top; nothing if there is none of that name.
[[nodiscard]] std::optional<double> NumberIn(std::string_view text, std::string_view name);
/// The same of a text.
[[nodiscard]] std::optional<std::string> StringIn(std::string_view text, std::string_view name);
/// A GeoJSON geometry (RFC 7946): longitude before latitude, rings closed, `openRings` the numbers
/// of those that were sent open. The direction of a ring is left as it was sent.
[[nodiscard]] std::string GeometryText(const model::ShapeData& data);

}  // namespace uplink::json
