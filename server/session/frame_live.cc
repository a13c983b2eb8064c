#include "server/session/frame_live.h"

#include <algorithm>
#include <utility>

#include "server/robot/live_parts.h"
#include "storage/live_parts.h"

namespace uplink::session {
namespace {

/// A later live message of the same frame replaces these kinds completely.
bool ReplacedWhole(model::Variant variant) {
  const std::optional<storage::LivePart> part = robot::PartOfVariant(variant);
  return part && storage::RowOf(*part).keys_max == 1;
}

}  // namespace

std::optional<model::Record> FrameLive::Add(model::Record record) {
  if (ReplacedWhole(record.variant())) {
    const auto before = std::ranges::find(records_, record.variant(), &model::Record::variant);
    if (before != records_.end()) {
      std::swap(*before, record);
      return record;
    }
  }
  records_.push_back(std::move(record));
  return std::nullopt;
}

FrameLive::Before FrameLive::Add(model::RcanState state) {
  const Before before = rcan_ ? Before::kReplaced : Before::kNone;
  rcan_ = std::move(state);
  return before;
}

std::size_t FrameLive::Apply(robot::RobotState& state, SteadyTime arrived, schema::Judge& judge) {
  std::size_t applied = records_.size();
  if (auto rcan = std::exchange(rcan_, std::nullopt)) {
    ++applied;
    state.Apply(*std::move(rcan), arrived);
  }
  if (records_.empty()) return applied;
  state.Apply(records_, arrived);
  for (model::Record& record : records_) judge.Reuse(std::move(record));
  records_.clear();
  return applied;
}

}  // namespace uplink::session
