#include "schema/rcan/judge.h"

#include <array>
#include <exception>
#include <optional>
#include <string>
#include <unordered_set>
#include <utility>

#include <boost/json.hpp>
#include <fmt/format.h>

#include "schema/base/utf8.h"
#include "schema/json/exact.h"
#include "schema/limits.h"
#include "schema/model/ids.h"
#include "schema/rcan/members.h"
#include "schema/rcan/ruri.h"
#include "schema/rules/describe.h"
#include "schema/rules/texts.h"

namespace uplink::schema {
namespace {

namespace js = boost::json;

constexpr std::int64_t kPercentWhole = 100;
/// Most states are parsed within this; larger ones take more from the heap.
constexpr std::size_t kParseBytes = std::size_t{16} * 1024;

RcanJudgement Rejected(const Violation& violation) {
  return {.verdict = violation.Describe(), .dropped = {}, .unlisted = {}};
}

std::optional<model::RcanPosition> PositionOf(Members& state, const Path& root,
                                              Violations& violations) {
  const js::value* value = state.Find("position", Need::kMay);
  if (value == nullptr) return std::nullopt;
  const js::object* object = value->if_object();
  if (object == nullptr) {
    state.ReportType(Need::kMay, "position", *value, "object");
    return std::nullopt;
  }
  const Path path = root.Field("position");
  Members members(*object, path, violations);
  // Both are required, of a member that is not: without one the position is dropped.
  if (!members.Has("x") || !members.Has("y")) return std::nullopt;
  const std::optional<double> x = members.Number("x", Need::kMay);
  const std::optional<double> y = members.Number("y", Need::kMay);
  const std::optional<double> heading = members.Number("heading_rad", Need::kMay);
  if (!x || !y) return std::nullopt;
  return model::RcanPosition{.x_m = *x, .y_m = *y, .heading_rad = heading};
}

/// What the joint is called; empty, after reporting it, if that cannot be told.
std::string NameOf(Members& joint, const Path& path) {
  if (!joint.Has("joint")) return {};
  std::optional<std::string> name = joint.Text("joint", Need::kMay, kIdBytesMax);
  if (!name) return {};
  if (name->empty()) {
    const Path field = path.Field("joint");
    joint.Report(Need::kMay, MissingField(field, "is empty"));
  }
  return *std::move(name);
}

/// The joint of that name, or nothing after reporting it: name and time are required, and without
/// one of them the joint is dropped, and nothing else with it.
std::optional<model::RcanJoint> JointOf(Members& members, const std::string& name) {
  if (name.empty() || !members.Has("timestamp_us")) return std::nullopt;
  const std::optional<std::int64_t> time = members.Whole("timestamp_us", Need::kMay, {});
  if (!time) return std::nullopt;
  model::RcanJoint joint;
  joint.joint = name;
  joint.timestamp_us = *time;
  joint.position_rad = members.Number("position_rad", Need::kMay);
  joint.velocity_rad_s = members.Number("velocity_rad_s", Need::kMay);
  joint.position_m = members.Number("position_m", Need::kMay);
  joint.velocity_m_s = members.Number("velocity_m_s", Need::kMay);
  joint.effort_nm = members.Number("effort_nm", Need::kMay);
  joint.temperature_c = members.Number("temperature_c", Need::kMay);
  joint.error_flags = members.Bits("error_flags");
  return joint;
}

std::vector<model::RcanJoint> JointsOf(Members& state, const Path& root, Violations& violations) {
  std::vector<model::RcanJoint> joints;
  const js::value* value = state.Find("joints", Need::kMay);
  if (value == nullptr) return joints;
  const js::array* items = value->if_array();
  if (items == nullptr) {
    state.ReportType(Need::kMay, "joints", *value, "array");
    return joints;
  }
  const Path list = root.Field("joints");
  if (items->size() > kRcanJointsMax) {
    violations.Reject(TooManyItems(list, items->size(), kRcanJointsMax, "joints"));
    return joints;
  }
  joints.reserve(items->size());
  std::unordered_set<std::string> names;
  for (std::size_t i = 0; i < items->size() && !violations.rejected(); ++i) {
    const Path item = list.Item(i);
    const js::object* object = (*items)[i].if_object();
    if (object == nullptr) {
      violations.Content(TypeMismatch(item, json::KindOf((*items)[i]), "object"));
      continue;
    }
    Members members(*object, item, violations);
    const std::string name = NameOf(members, item);
    std::optional<model::RcanJoint> joint = JointOf(members, name);
    // Also of a joint that is dropped for another violation.
    if (!name.empty() && !names.insert(name).second) {
      const Path field = item.Field("joint");
      violations.Reject(DuplicateKey(field, name));
    }
    if (joint) joints.push_back(*std::move(joint));
  }
  return joints;
}

/// Whether the state names this robot as its sender. Reports a violation if it does not.
bool CheckRuri(Members& state, const Path& root, std::string_view ruri, Violations& violations) {
  // As it was sent: it is compared, and not kept.
  const std::optional<std::string_view> said = state.String("ruri", Need::kMust);
  if (!said) return false;
  const Path field = root.Field("ruri");
  // The whole text has its limit already. The RURI's length is that without the signature, which
  // may be longer than the rest.
  TextFinding found = ReadText(field, *said, said->size());
  if (!found.violation) found = ReadText(field, WithoutSignature(*said), model::kRuriBytesMax);
  if (found.violation) {
    violations.Reject(*found.violation);
    return false;
  }
  if (NormalRuri(*said) == NormalRuri(ruri)) return true;
  violations.Reject(IdentityMismatch(field, *said, ruri));
  return false;
}

RcanJudgement JudgeObject(const js::object& object, std::string_view ruri, TextForm texts) {
  const Path root;
  Violations violations({.texts = texts});
  Members members(object, root, violations);
  const bool own = CheckRuri(members, root, ruri, violations);
  model::RcanState state;
  state.timestamp_us = members.Whole("timestamp_us", Need::kMust, {}).value_or(0);
  state.seq = members.Whole("seq", Need::kMay, {.min = 1});
  state.uptime_ms = members.Whole("uptime_ms", Need::kMay, {});
  state.battery_v = members.NumberFrom("battery_v", 0);
  state.battery_pct = members.Whole("battery_pct", Need::kMay, {.max = kPercentWhole});
  state.position = PositionOf(members, root, violations);
  state.joints = JointsOf(members, root, violations);
  state.clock_source = members.Text("clock_source", Need::kMay, kNameBytesMax);
  if (violations.rejected()) {
    return {
        .verdict = violations.TakeRejection(), .dropped = {}, .unlisted = {}, .sign_of_life = own};
  }
  return {.verdict = std::move(state),
          .dropped = violations.TakeDropped(),
          .unlisted = violations.TakeUnlisted(),
          .control_characters = violations.control_characters(),
          .sign_of_life = own};
}

RcanJudgement JudgeText(std::string_view text, std::string_view ruri, TextForm texts) {
  std::array<unsigned char, kParseBytes> buffer;  // NOLINT(*-member-init): the parser's to fill
  js::monotonic_resource memory(buffer.data(), buffer.size());
  js::parse_options options;
  options.max_depth = kRcanDepthMax;
  js::error_code error;
  const js::value value =
      js::parse(js::string_view(text.data(), text.size()), error, &memory, options);
  if (error == js::error::exponent_overflow) return Rejected(BeyondDouble());
  if (error) return Rejected(Malformed(error.message()));
  if (const js::object* object = value.if_object()) return JudgeObject(*object, ruri, texts);
  return Rejected(TypeMismatch(Path(), json::KindOf(value), "object"));
}

}  // namespace

RcanJudgement JudgeRcanState(std::string_view text, std::string_view ruri, std::size_t bytes_max,
                             TextForm texts) {
  if (text.size() > bytes_max) return Rejected(PayloadTooLarge(text.size(), bytes_max));
  if (!IsCleanUtf8(text)) return Rejected(TextNotUtf8(Path(), text));
  try {
    return JudgeText(text, ruri, texts);
  } catch (const std::exception& error) {
    return Rejected(Malformed(error.what()));
  }
}

model::Rejection NotMonotonic(std::string_view field, std::int64_t value, std::int64_t last) {
  return {.reason = model::RejectReason::kNotMonotonic,
          .field = std::string(field),
          .detail = fmt::format("{} is before {}, the time of the state before", value, last)};
}

}  // namespace uplink::schema
