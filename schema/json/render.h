#pragma once

#include <string_view>
#include <type_traits>

#include <boost/json.hpp>

#include "schema/model/rcan.h"
#include "schema/model/record.h"

/// The model as JSON values, by the specification's names: absent optionals are absent, hasX flags
/// never appear, enumerants are names, a Value is its bare scalar, a void union member is null,
/// 32-bit floats are the double that they are. What is shown was judged before, so every number is
/// finite. Pure; any thread.
namespace uplink::json {

/// An object; of the settings the bare list of the specification (RenderByKey is what operators
/// see).
template <typename Body>
using Rendered = std::conditional_t<std::is_same_v<Body, model::CurrentSettings>,
                                    boost::json::array, boost::json::object>;

// One per row of model/variants.h, in the file of its family.
#define UPLINK_VARIANT(Member, name, Body, settling) \
  [[nodiscard]] Rendered<model::Body> Render(const model::Body& body);
UPLINK_VARIANTS(UPLINK_VARIANT)
#undef UPLINK_VARIANT

/// A Robot State as RCAN spells it; JudgeRcanState reads it again. The server's own count is not in
/// it.
[[nodiscard]] boost::json::object Render(const model::RcanState& state, std::string_view ruri);

/// The whole message: `{"motionTelemetry": {...}}`.
[[nodiscard]] boost::json::object RenderBody(const model::Body& body);

// Parts that views show on their own.
[[nodiscard]] boost::json::object Render(const model::Pose& pose);
[[nodiscard]] boost::json::object Render(const model::Trajectory& trajectory);
[[nodiscard]] boost::json::value Render(const model::Value& value);
/// What the event's union member holds: Event.detail; empty for the e-stop kinds, and for a named
/// event whose detail is no object.
[[nodiscard]] boost::json::object RenderDetail(const model::EventKind& kind);
/// Key to value.
[[nodiscard]] boost::json::object RenderByKey(const model::CurrentSettings& settings);

}  // namespace uplink::json
