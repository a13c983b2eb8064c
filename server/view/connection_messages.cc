#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "schema/model/connection.h"
#include "schema/model/ids.h"
#include "schema/model/message_source.h"
#include "server/view/messages.h"
#include "server/view/timestamps.h"

// Connections of robots, and entries of their stories.
namespace uplink::view {
namespace {

void SetCertificate(const storage::CertificateFacts& facts, v1::Connection& connection) {
  if (facts.serial.empty() && facts.sha256.empty()) return;
  v1::ConnectionCertificate& certificate = *connection.mutable_certificate();
  certificate.set_serial(facts.serial);
  certificate.set_sha256(facts.sha256);
  certificate.set_key_sha256(facts.key_sha256);
  SetTime(certificate, &v1::ConnectionCertificate::mutable_not_after, facts.not_after);
}

void SetHeldBack(const storage::ConnectionRow& row, v1::Connection& connection) {
  if (row.held_back_ms == 0 && row.held_back_why.empty()) return;
  v1::ConnectionHeldBack& held_back = *connection.mutable_held_back();
  held_back.set_total_ms(row.held_back_ms);
  held_back.set_why(row.held_back_why);
}

void SetEnd(const storage::ConnectionRow& row, v1::Connection& connection) {
  if (!row.ended_at) return;
  v1::ConnectionEnd& end = *connection.mutable_end();
  SetTime(end, &v1::ConnectionEnd::mutable_at, row.ended_at);
  if (row.why) end.set_why(std::string(model::ToText(*row.why)));
  end.set_code(row.code);
  end.set_detail(row.detail);
}

}  // namespace

v1::Connection ToMessage(const storage::ConnectionRow& row) {
  constexpr std::uint32_t kTakeoversMax = std::numeric_limits<std::int32_t>::max();
  v1::Connection connection;
  connection.set_ruri(row.robot.ruri);
  connection.set_id(model::SessionId(row.id).ToHex());
  connection.set_source(std::string(model::ToText(row.source)));
  SetTime(connection, &v1::Connection::mutable_began_at, row.began_at);
  connection.set_server(row.server);
  connection.set_address(row.address);
  connection.set_gateway(row.gateway);
  connection.set_agent_version(row.agent_version);
  connection.set_messages(Signed(row.messages));
  connection.set_bytes(Signed(row.bytes));
  connection.set_takeovers(static_cast<std::int32_t>(std::min(row.takeovers, kTakeoversMax)));
  SetCertificate(row.certificate, connection);
  SetHeldBack(row, connection);
  SetEnd(row, connection);
  return connection;
}

v1::StoryEntry ToMessage(const StoryEntry& entry) {
  v1::StoryEntry message;
  SetTime(message, &v1::StoryEntry::mutable_at, entry.place.at);
  message.set_kind(std::string(ToText(entry.place.kind)));
  message.set_title(entry.title);
  return message;
}

TextMembers TextsOf(const StoryEntry& entry) {
  TextMembers texts;
  texts.AddStored("detail", entry.detail_json);
  return texts;
}

}  // namespace uplink::view
