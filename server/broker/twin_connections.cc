#include "server/broker/twin_connections.h"

#include <algorithm>
#include <iterator>

#include "schema/base/utf8.h"
#include "schema/model/ids.h"

namespace uplink::broker {
namespace {

using model::cyberwave::MarkKind;
using transport::EndCause;

/// Bytes of a client's id that are shown.
constexpr std::size_t kClientBytesMax = 128;

template <typename Marks>
auto FindMark(Marks& marks, const std::string& session) {
  return std::find_if(marks.begin(), marks.end(),
                      [&](const auto& mark) { return mark.session == session; });
}

template <typename Marks>
void NoteMark(Marks& marks, const std::string& session, const cyberwave::Arrival& at) {
  if (const auto found = FindMark(marks, session); found != marks.end()) marks.erase(found);
  marks.push_back({.session = session, .at = at});
  if (marks.size() > kTwinConnectionsMax) marks.pop_front();
}

template <typename One>
storage::ConnectionItem ItemOf(const robot::Robot& robot, const One& one) {
  storage::ConnectionItem item;
  item.robot = robot.id();
  item.id = one.id;
  item.source = model::MessageSource::kCyberwave;
  item.began_at = one.began_at;
  item.address = PrintableUtf8(one.session, kClientBytesMax);
  item.messages = one.messages;
  item.bytes = one.bytes;
  return item;
}

}  // namespace

void TwinConnections::Hear(robot::ConnectionReports& reports, robot::Robot& robot,
                           const Heard& heard) {
  robot.traffic.CountMessages(1);
  robot.traffic.CountBytes(heard.bytes);
  if (heard.live && last_live_ != heard.session) last_live_ = heard.session;
  if (heard.mark != nullptr) TakeMark(reports, robot, heard);
  Ones::iterator one = Find(heard.session);
  if (one == ones_.end() && heard.live) one = Begin(reports, robot, heard);
  if (one == ones_.end()) return;
  one->heard = heard.arrived;
  ++one->messages;
  one->bytes += heard.bytes;
  if (heard.arrived.steady - one->kept_at < robot::kConnectionUpdateEvery) return;
  one->kept_at = heard.arrived.steady;
  reports.Update(ItemOf(robot, *one));
}

TwinConnections::Ones::iterator TwinConnections::Find(const std::string& session) {
  // Nearly always the one that was heard last.
  const auto found = std::find_if(ones_.rbegin(), ones_.rend(),
                                  [&](const One& one) { return one.session == session; });
  if (found == ones_.rend()) return ones_.end();
  ones_.splice(ones_.end(), ones_, std::prev(found.base()));
  return std::prev(ones_.end());
}

TwinConnections::Ones::iterator TwinConnections::Begin(robot::ConnectionReports& reports,
                                                       robot::Robot& robot, const Heard& heard) {
  if (const auto left = FindMark(left_, heard.session); left != left_.end()) {
    if (heard.arrived.steady - left->at.steady < kTwinReturnsAfter) return ones_.end();
    left_.erase(left);
  }
  if (ones_.size() >= kTwinConnectionsMax) {
    End(reports, robot, ones_.begin(), heard.arrived.system, EndCause::kSuperseded);
  }
  One one;
  one.session = heard.session;
  one.began_at = heard.arrived.system;
  one.heard = heard.arrived;
  one.kept_at = heard.arrived.steady;
  if (const auto came = FindMark(came_, heard.session); came != came_.end()) {
    one.began_at = came->at.system;
    came_.erase(came);
  }
  one.id = reports.Begin(robot, ItemOf(robot, one));
  return ones_.insert(ones_.end(), std::move(one));
}

void TwinConnections::TakeMark(robot::ConnectionReports& reports, robot::Robot& robot,
                               const Heard& heard) {
  const Ones::iterator one = Find(heard.session);
  if (heard.mark->kind == MarkKind::kDisconnected && last_live_ == heard.session) {
    robot.state.Park(heard.arrived.system + heard.parked_max,
                     heard.arrived.steady + kTwinReturnsAfter, heard.arrived.steady);
  }
  if (heard.mark->kind == MarkKind::kConnected) {
    if (const auto left = FindMark(left_, heard.session); left != left_.end()) left_.erase(left);
    if (one == ones_.end()) NoteMark(came_, heard.session, heard.arrived);
  }
  if (heard.mark->kind != MarkKind::kDisconnected || one == ones_.end()) return;
  NoteMark(left_, heard.session, heard.arrived);
  End(reports, robot, one, heard.arrived.system, EndCause::kClosed);
}

void TwinConnections::End(robot::ConnectionReports& reports, robot::Robot& robot,
                          Ones::iterator one, SystemTime at, EndCause cause) {
  storage::ConnectionItem item = ItemOf(robot, *one);
  item.ended = storage::ConnectionEnded{.at = at,
                                        .why = transport::WhyOf(cause),
                                        .code = {},
                                        .detail = std::string(transport::SentenceOf(cause))};
  ones_.erase(one);
  reports.End(robot, std::move(item));
}

void TwinConnections::EndSilent(robot::ConnectionReports& reports, robot::Robot& robot,
                                SteadyTime now, SteadyTime heard_all_since) {
  while (!ones_.empty()) {
    const cyberwave::Arrival heard = ones_.front().heard;
    if (now - std::max(heard.steady, heard_all_since) < kTwinSilentMax) return;
    End(reports, robot, ones_.begin(), heard.system, EndCause::kUnanswered);
  }
}

void TwinConnections::EndAll(robot::ConnectionReports& reports, robot::Robot& robot, SystemTime now,
                             EndCause cause) {
  while (!ones_.empty()) End(reports, robot, ones_.begin(), now, cause);
}

}  // namespace uplink::broker
