#include "tests/bench/store_load.h"

#include "schema/model/status.h"
#include "tests/support/records.h"

namespace uplink::bench {

BatchSource::BatchSource(const LoadShape& shape, std::size_t writer, SystemTime at) {
  for (std::size_t i = 0; i < shape.batch_records; ++i) {
    if (i % shape.per_robot == 0) {
      const std::string ruri = "rcan://bench.rcan/uplink/synthetic/1.0/writer-" +
                               std::to_string(writer) + "-robot-" + std::to_string(opens_.size());
      opens_.push_back({std::make_shared<const model::RobotId>(model::RobotId{ruri, "bench"}),
                        model::SessionId({1, static_cast<std::uint8_t>(writer)}),
                        0,
                        at,
                        {}});
    }
    model::Message message;
    message.unix_time_ms = UnixMs(at);
    message.message = std::string(shape.text_bytes, 'm');
    const storage::OpenRequest& open = opens_.back();
    batch_.records.push_back({open.robot, open.session, i % shape.per_robot + 1, 0, at,
                              test::RecordOf(message), std::string(shape.text_bytes, 'p'),
                              shape.text_bytes});
  }
  // Next begins by moving on.
  for (storage::CommitRecord& record : batch_.records) record.seq -= shape.per_robot;
}

void BatchSource::SetHolds(const std::vector<storage::OpenResult>& opened) {
  std::size_t robot = 0;
  for (storage::CommitRecord& record : batch_.records) {
    while (opens_[robot].robot != record.robot) ++robot;
    record.held_since = opened[robot].held_since;
    record.seq += opened[robot].cursor;
  }
}

const storage::Batch& BatchSource::Next() {
  const storage::RobotRef first = batch_.records.front().robot;
  std::size_t per_robot = 0;
  while (per_robot < batch_.records.size() && batch_.records[per_robot].robot == first) ++per_robot;
  for (storage::CommitRecord& record : batch_.records) record.seq += per_robot;
  return batch_;
}

}  // namespace uplink::bench
