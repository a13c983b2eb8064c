#include "schema/model/record.h"

#include <type_traits>

namespace uplink::model {

// Not inline: moving a Body instantiates the moves of all its alternatives, wherever a unit reads
// this.
Record::Record(Body body, std::vector<DroppedField> dropped, std::vector<UnlistedFields> unlisted,
               std::size_t payload_bytes)
    : body_(std::move(body)),
      dropped_(std::move(dropped)),
      unlisted_(std::move(unlisted)),
      payload_bytes_(payload_bytes) {}

std::int64_t SampledUnixMs(const Body& body) {
  return std::visit(
      []<typename Message>(const Message& message) -> std::int64_t {
        if constexpr (std::is_same_v<Message, ObjectOp>) {
          return message.upsert() == nullptr ? 0 : message.upsert()->unix_time_ms;
        } else if constexpr (requires { message.unix_time_ms; }) {
          return message.unix_time_ms;
        } else {
          return 0;
        }
      },
      body);
}

}  // namespace uplink::model
