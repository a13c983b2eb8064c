// With which status the server may end a stream, by what happened to it; and a run as text.
#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "tests/simulation/world.h"

namespace uplink::simulation {

void World::CheckEnds() {
  for (auto& [id, stream] : server_->streams()) {
    const auto end = stream->TakeEnd();
    if (!end) continue;
    ++result_.ends[end->code()];
    if (MayEnd(id, *stream, end->code())) continue;
    recorder_.Violate(fmt::format("a stream of {} was ended {}: {}, and nothing called for it",
                                  stream->ruri(), absl::StatusCodeToString(end->code()),
                                  std::string(end->message())));
  }
}

bool World::MayEnd(std::uint64_t id, const SimStream& stream, absl::StatusCode code) {
  const auto half_closed = stream.half_closed_at();
  switch (code) {
    case absl::StatusCode::kOk:
      return half_closed.has_value();
    case absl::StatusCode::kAborted: {
      if (server_->NewestOf(stream.ruri()) > id) return true;
      // Its robot's hold is lost with the commit that began it.
      if (went_back_) return true;
      // It was fenced, or finds that its robot is held anew.
      std::uint64_t& deletions = deletions_[stream.ruri()];
      if (deletions == 0) return false;
      --deletions;
      return true;
    }
    case absl::StatusCode::kUnavailable:
      return server_->draining || went_back_ ||
             (half_closed && clock_.Steady() - *half_closed >= limits_.session.drain_timeout);
    case absl::StatusCode::kInvalidArgument:
      // The agents make no mistake; but the network may keep a Hello for too long.
      return stream.batches_seen() == 0 &&
             clock_.Steady() - stream.opened_at() >= session::kHelloWait;
    case absl::StatusCode::kResourceExhausted:
      // The agents read and never leave kSessionsMax sessions waiting; but streams that they left
      // may wait for their turn still.
      return std::ranges::count_if(server_->streams(), [&stream](const auto& other) {
               return other.second->ruri() == stream.ruri() && !other.second->session().done();
             }) >= static_cast<std::ptrdiff_t>(robot::kStreamsWaitingMax);
    default:
      return false;
  }
}

std::string ToText(const RunResult& result) {
  const metrics::MessageCounts& uplinks = result.uplinks;
  std::string text = fmt::format(
      "violation {}\nsteps {}\nkills {}\nbreaks {}\ndeletions {}\nfailovers {}\nfloods {}\nheld "
      "back {}\nreceived "
      "{}\nstored {}\n"
      "applied {}\nsuperseded {}\nduplicate {}\nrejected {}\nin flight {}\nmissing {}\n",
      result.violation, result.steps, result.kills, result.breaks, result.deletions,
      result.failovers, result.floods, result.held_back, uplinks.received, uplinks.stored,
      uplinks.applied, uplinks.superseded, uplinks.duplicate, uplinks.rejected, uplinks.in_flight,
      uplinks.missing);
  const auto add_all = [&text](const char* name, const auto& counts) {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (counts[i] > 0) text += fmt::format("{} {}: {}\n", name, i, counts[i]);
    }
  };
  add_all("reject", uplinks.rejects);
  add_all("record", uplinks.records);
  const forward::Counts& forwards = result.forwards;
  text += fmt::format(
      "forwards due {} written {} coalesced {} replaced {} dropped {} snapshots {} of {}\n",
      forwards.due, forwards.written, forwards.coalesced, forwards.replaced, forwards.dropped,
      forwards.snapshots, forwards.snapshot_items);
  for (const auto& [code, count] : result.ends) {
    text += fmt::format("ended {}: {}\n", absl::StatusCodeToString(code), count);
  }
  return text;
}

}  // namespace uplink::simulation
