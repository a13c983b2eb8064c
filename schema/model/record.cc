#include "schema/model/record.h"

namespace uplink::model {

// Not inline: moving a Body instantiates the moves of all its alternatives, wherever a unit reads
// this.
Record::Record(Body body, std::vector<DroppedField> dropped, std::vector<UnlistedFields> unlisted,
               std::size_t payload_bytes)
    : body_(std::move(body)),
      dropped_(std::move(dropped)),
      unlisted_(std::move(unlisted)),
      payload_bytes_(payload_bytes) {}

}  // namespace uplink::model
