#include "server/rcan/joint_series.h"

#include <array>
#include <cmath>
#include <map>
#include <string_view>
#include <variant>
#include <vector>

namespace uplink::rcan {
namespace {

using metrics::rcan::kJointSeries;
using metrics::rcan::SeriesId;

constexpr std::string_view kPrefix = "joint/";

/// The values of one joint, by SeriesId.
using Samples = std::array<std::optional<double>, kJointSeries>;
static_assert(kJointSeries <= SeriesNames::kOfLabelMax);

Samples SamplesOf(const model::RcanJoint& joint) {
  std::optional<double> flags;
  if (joint.error_flags) flags = static_cast<double>(*joint.error_flags);
  return {joint.position_rad,
          joint.velocity_rad_s,
          joint.position_m,
          joint.velocity_m_s,
          joint.effort_nm,
          joint.temperature_c,
          flags};
}

void AddSamples(std::string_view joint, const Samples& samples, NamedSeries& series) {
  series.Add(SeriesId::kJointPositionRad, joint, samples);
}

/// A reading of a joint among extras.
struct Reading {
  std::string_view joint;
  std::size_t series = 0;
  double value = 0;
};

std::optional<Reading> ReadingOf(std::string_view key, const model::Value& value) {
  if (!key.starts_with(kPrefix)) return std::nullopt;
  const std::size_t slash = key.rfind('/');
  if (slash <= kPrefix.size()) return std::nullopt;
  const std::size_t series = metrics::rcan::JointSeriesOf(key.substr(slash + 1));
  const std::optional<double> number = NumberOf(value);
  if (series >= kJointSeries || !number) return std::nullopt;
  return Reading{key.substr(kPrefix.size(), slash - kPrefix.size()), series, *number};
}

}  // namespace

std::optional<double> NumberOf(const model::Value& value) {
  if (const auto* whole = std::get_if<std::int32_t>(&value)) return *whole;
  if (const auto* on = std::get_if<bool>(&value)) return *on ? 1 : 0;
  const auto* number = std::get_if<double>(&value);
  if (number == nullptr || !std::isfinite(*number)) return std::nullopt;
  return *number;
}

void AddJoints(const model::RcanState& state, NamedSeries& series) {
  for (const model::RcanJoint& joint : state.joints) {
    AddSamples(joint.joint, SamplesOf(joint), series);
  }
}

void AddJoints(const robot::StateView& view, NamedSeries& series) {
  const std::vector<model::RcanJoint> none;
  const std::vector<model::RcanJoint>& said = view.parts.rcan ? view.parts.rcan->joints : none;
  // Nearly no robot has joints among its extras: then there is nothing to merge.
  std::map<std::string_view, Samples> merged;
  for (const auto& [key, extra] : view.parts.extras.items()) {
    const std::optional<Reading> reading = ReadingOf(key, extra.value);
    if (!reading) continue;
    if (merged.empty()) {
      for (const model::RcanJoint& joint : said) merged.emplace(joint.joint, SamplesOf(joint));
    }
    // Shown if it is newer than the Robot State, or if that lacks it.
    std::optional<double>& kept = merged[reading->joint][reading->series];
    if (!kept || extra.arrived > view.rcan_arrived) kept = reading->value;
  }
  if (merged.empty() && view.parts.rcan) AddJoints(*view.parts.rcan, series);
  for (const auto& [joint, samples] : merged) AddSamples(joint, samples, series);
}

}  // namespace uplink::rcan
