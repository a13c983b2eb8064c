#include "server/robot/connection_reports.h"

#include <utility>

#include "schema/base/utf8.h"
#include "schema/model/message_source.h"

namespace uplink::robot {

void ConnectionReports::SetServer(std::string server) {
  const std::lock_guard lock(mutex_);
  server_ = std::move(server);
}

storage::ConnectionId ConnectionReports::Begin(Robot& robot, storage::ConnectionItem item) {
  item.id = DrawId();
  Complete(item);
  robot.state.BeginConnection();
  robot.agent.Begin(item);
  if (const auto left_out = robot.connection_lines.Take(context_.clock.Steady())) {
    context_.logger.Info("robot_connected", {{"robot", item.robot->ruri},
                                             {"source", model::ToText(item.source)},
                                             {"peer", item.address},
                                             {"gateway", item.gateway},
                                             {"agent_version", item.agent_version},
                                             {"certificate", item.certificate.serial},
                                             {"suppressed", *left_out}});
  }
  const storage::ConnectionId id = item.id;
  if (context_.sink != nullptr) context_.sink->Begin(std::move(item));
  return id;
}

void ConnectionReports::Update(storage::ConnectionItem item) {
  if (context_.sink == nullptr) return;
  Complete(item);
  context_.sink->Update(std::move(item));
}

void ConnectionReports::End(Robot& robot, storage::ConnectionItem item) {
  Complete(item);
  storage::ConnectionEnded& ended = *item.ended;
  ended.detail = PrintableUtf8(ended.detail, storage::kConnectionDetailMax);
  robot.state.EndConnection(ended.why);
  robot.agent.End(item.id);
  if (const auto left_out = robot.connection_lines.Take(context_.clock.Steady())) {
    const auto seconds =
        std::chrono::duration_cast<std::chrono::seconds>(ended.at - item.began_at).count();
    context_.logger.Info("robot_disconnected", {{"robot", item.robot->ruri},
                                                {"source", model::ToText(item.source)},
                                                {"peer", item.address},
                                                {"gateway", item.gateway},
                                                {"why", model::ToText(ended.why)},
                                                {"code", ended.code},
                                                {"detail", ended.detail},
                                                {"seconds", seconds},
                                                {"messages", item.messages},
                                                {"suppressed", *left_out}});
  }
  if (context_.sink != nullptr) context_.sink->End(std::move(item));
}

storage::ConnectionId ConnectionReports::DrawId() {
  constexpr std::size_t kBytesOfNumber = sizeof(std::uint64_t);
  const std::lock_guard lock(mutex_);
  storage::ConnectionId id{};
  for (std::size_t at = 0; at < id.size(); at += kBytesOfNumber) {
    const std::uint64_t drawn = random_();
    for (std::size_t i = 0; i < kBytesOfNumber; ++i) {
      id[at + i] = static_cast<std::uint8_t>(drawn >> (8 * i));
    }
  }
  return id;
}

void ConnectionReports::Complete(storage::ConnectionItem& item) const {
  item.process = context_.process;
  const std::lock_guard lock(mutex_);
  item.server = server_;
}

}  // namespace uplink::robot
