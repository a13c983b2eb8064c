#include "server/ingest/room.h"

#include <algorithm>

#include "schema/model/held_bytes.h"

namespace uplink::ingest {
namespace {

Block FindBlockOfStream(const Line& line, const RecordCost& cost, const RoomTerms& terms) {
  const robot::JournalUse use = line.robot.journal_use();
  if (use.records >= terms.in_flight_max) return {.by = HeldBack::kInFlight};
  switch (line.journal.RoomFor(use, cost.journal_bytes, line.by.gateway.get())) {
    case journal::Room::kShareFull:
      return {.by = HeldBack::kJournalShare};
    case journal::Room::kFull:
      return {.by = HeldBack::kJournal};
    case journal::Room::kFree:
      break;
  }
  const SteadyTime now = terms.clock.Steady();
  const robot::DurableFlow::Answer flow =
      cost.flow_bytes ? line.robot.flow.LookAt(*cost.flow_bytes, terms.flow, now)
                      : line.robot.flow.LookAtDisk(now);
  if (flow.by == HeldBack::kNone) return {};
  return {.by = flow.by, .until = flow.again};
}

/// Why the robot alone asks for too much; kNone if it does not.
HeldBack ExcessOf(const Line& line, Waits waits, const RecordCost& cost, const RoomTerms& terms) {
  const robot::DurableFlow& flow = line.robot.flow;
  const SteadyTime now = terms.clock.Steady();
  // If nothing may be stored at all, this robot is not the reason.
  if (!cost.flow_bytes || flow.LookAtDisk(now).by != HeldBack::kNone) return HeldBack::kNone;
  const bool is_short = flow.disk_limits() || terms.journal_over_half;
  if (waits == Waits::kBroker && !is_short) return HeldBack::kNone;
  return flow.LookAt(*cost.flow_bytes, terms.flow, now).by;
}

}  // namespace

std::size_t FlowBytes(std::size_t payload_bytes, const model::Record& record) {
  return std::max(payload_bytes, model::HeldBytes(record));
}

Block FindBlock(const Line& line, Waits waits, const RecordCost& cost, const RoomTerms& terms) {
  if (waits == Waits::kStream) return FindBlockOfStream(line, cost, terms);
  if (const HeldBack by = ExcessOf(line, waits, cost, terms); by != HeldBack::kNone) {
    return {.by = by, .is_excess = true};
  }
  if (!line.journal.HasRoom()) return {.by = HeldBack::kJournal};
  const robot::DurableFlow::Answer disk = line.robot.flow.LookAtDisk(terms.clock.Steady());
  if (disk.by != HeldBack::kNone) return {.by = disk.by, .until = disk.again};
  if (waits == Waits::kBroker) return {};
  const journal::Room room = line.journal.RoomFor(line.robot.journal_use(), cost.journal_bytes);
  return {.by = room == journal::Room::kShareFull ? HeldBack::kJournalShare : HeldBack::kNone};
}

}  // namespace uplink::ingest
