#include "server/session/batch_check.h"

#include <string>

#include <fmt/format.h>

namespace uplink::session {
namespace {

std::string SeqFault(model::Seq seq, model::Seq last) {
  if (seq == 0) return "it must be at least 1";
  if (seq > model::kSeqMax) return fmt::format("{} is over 2^63-1", seq);
  if (seq <= last) return fmt::format("{} does not increase over {}", seq, last);
  if (last > 0 && seq - last > kSeqJumpMax) {
    return fmt::format("{} jumps over more than 2^32 numbers from {}", seq, last);
  }
  return {};
}

}  // namespace

absl::Status CheckBatch(const BatchView& batch, model::Seq last_seq, const SessionLimits& limits,
                        std::uint64_t frame) {
  if (batch.uplinks.size() > limits.batch_uplinks_max) {
    return absl::InvalidArgumentError(
        fmt::format("frame {}: batch.uplinks: {} messages, the limit is {} "
                    "(limits.batch_uplinks_max)",
                    frame, batch.uplinks.size(), limits.batch_uplinks_max));
  }
  model::Seq last = last_seq;
  for (std::size_t i = 0; i < batch.uplinks.size(); ++i) {
    const model::Seq seq = batch.uplinks[i].seq;
    // The usual case, which makes no text.
    if (seq == last + 1 && seq <= model::kSeqMax) {
      last = seq;
      continue;
    }
    if (const std::string fault = SeqFault(seq, last); !fault.empty()) {
      return absl::InvalidArgumentError(
          fmt::format("frame {}: batch.uplinks[{}].seq: {}", frame, i, fault));
    }
    last = seq;
  }
  return absl::OkStatus();
}

}  // namespace uplink::session
