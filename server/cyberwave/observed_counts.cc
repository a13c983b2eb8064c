#include "server/cyberwave/observed_counts.h"

namespace uplink::cyberwave {

void ObservedCounts::CountMedia(TopicKind kind, std::size_t bytes) {
  MediaCount& count = kind == TopicKind::kDepth ? depth_ : pointcloud_;
  ++count.messages;
  count.bytes += bytes;
}

MediaCount ObservedCounts::media(TopicKind kind) const {
  if (kind == TopicKind::kDepth) return depth_;
  return kind == TopicKind::kPointcloud ? pointcloud_ : MediaCount();
}

void ObservedCounts::Take(TopicKind kind, const model::cyberwave::CommandHead& head,
                          const model::cyberwave::Source& source, const Stamp& stamp) {
  Count(kind);
  // Only answers have a status; some name their subject as commands do.
  if (head.status.empty()) {
    last_command_ = {.topic = kind, .head = head, .source = source, .stamp = stamp};
  } else if (last_command_ && last_command_->topic == kind) {
    last_command_->head.status = head.status;
  }
}

}  // namespace uplink::cyberwave
