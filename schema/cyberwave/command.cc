#include "schema/cyberwave/families.h"
#include "schema/limits.h"

namespace uplink::cyberwave {

using model::cyberwave::CommandHead;
using model::cyberwave::Ping;

CommandHead ReadCommand(Reader& in) {
  const bool named = in.Find("command") != nullptr;
  CommandHead head;
  head.command = in.Text(named ? "command" : "type", schema::kNameBytesMax);
  head.status = in.Text("status", schema::kNameBytesMax);
  head.action_id = in.Text("action_id", schema::kIdBytesMax);
  return head;
}

Ping ReadPing(Reader& in) {
  (void)in.Text("type", schema::kNameBytesMax, Need::kMust);
  return {};
}

}  // namespace uplink::cyberwave
