#include "server/broker/records_of.h"

#include <string_view>
#include <utility>
#include <variant>

namespace uplink::broker {
namespace {

storage::CommitContent ContentOf(cyberwave::DurableRecord&& record) {
  return std::visit(
      [](auto&& each) { return storage::CommitContent(std::forward<decltype(each)>(each)); },
      std::move(record));
}

}  // namespace

std::vector<storage::CommitRecord> RecordsOf(std::vector<cyberwave::DurableRecord> made,
                                             const mqtt::Publish& publish, SystemTime arrived) {
  std::vector<storage::CommitRecord> records;
  records.reserve(made.size());
  for (cyberwave::DurableRecord& each : made) {
    records.push_back({.received_at = arrived,
                       .content = ContentOf(std::move(each)),
                       .payload = "",
                       .payload_bytes = publish.payload_bytes});
  }
  // The store may refuse it; of many records one has what all of them came from.
  if (!records.empty()) records.front().payload = publish.payload.value_or(std::string_view());
  return records;
}

std::vector<storage::CommitRecord> RecordsOf(const model::Rejection& rejection,
                                             const mqtt::Publish& publish, SystemTime arrived,
                                             std::string payload) {
  std::vector<storage::CommitRecord> records;
  records.push_back({.received_at = arrived,
                     .content = storage::QuarantineItem{.rejection = rejection},
                     .payload = std::move(payload),
                     .payload_bytes = publish.payload_bytes});
  return records;
}

}  // namespace uplink::broker
