#include "server/journal/entry_queue.h"

#include <iterator>
#include <utility>

namespace uplink::journal {

/// A batch while it is being filled.
struct EntryQueue::Filling {
  GatheredBatch& batch;
  const HeldRobots& held;
  BatchShares shares;
  std::size_t bytes = 0;
  std::optional<SteadyTime> oldest{};

  /// The first message of `from`, whose first entry was admitted: all of it counts for its robot's
  /// share.
  void AddMessage(std::deque<Entry>& from) {
    bool continues = true;
    for (bool first = true; continues; first = false) {
      Entry& entry = from.front();
      if (!first) (void)shares.Admit(entry.origin);
      continues = entry.origin.continues;
      bytes += entry.origin.bytes;
      if (!oldest || entry.origin.arrived < *oldest) oldest = entry.origin.arrived;
      batch.Add(std::move(entry));
      from.pop_front();
    }
  }
};

void EntryQueue::Push(Entry entry) {
  LineOf(entry.origin, End::kLast).entries.push_back(std::move(entry));
}

void EntryQueue::PutBack(std::vector<Entry> entries) {
  for (; !entries.empty(); entries.pop_back()) {
    Line& line = LineOf(entries.back().origin, End::kFirst);
    line.entries.push_front(std::move(entries.back()));
  }
}

EntryQueue::Line& EntryQueue::LineOf(const Origin& origin, End end) {
  const auto [at, is_new] = lines_.try_emplace(origin.client.get());
  if (!is_new) return *at->second;
  const auto certificate = CertificateOf(origin.place.gateway(), end);
  Lines& lines = certificate->lines;
  at->second = lines.insert(end == End::kFirst ? lines.begin() : lines.end(), {certificate, {}});
  return *at->second;
}

EntryQueue::Certificates::iterator EntryQueue::CertificateOf(const GatewayRef& gateway, End end) {
  const auto known = gateways_.find(gateway.get());
  if (known != gateways_.end()) return known->second;
  const auto made = new_.insert(end == End::kFirst ? new_.begin() : new_.end(), {gateway, {}});
  if (gateway != nullptr) gateways_.emplace(gateway.get(), made);
  return made;
}

std::optional<SteadyTime> EntryQueue::MoveTo(GatheredBatch& batch, const BatchBounds& bounds,
                                             const HeldRobots& held) {
  Filling filling{
      .batch = batch, .held = held, .shares = BatchShares(bounds.robot, bounds.gateway)};
  // A batch of one entry goes to the halves in turn.
  old_first_ = !old_first_;
  GiveTurns(old_, filling, (bounds.records_max + (old_first_ ? 1 : 0)) / 2, bounds.bytes_max / 2);
  GiveTurns(new_, filling, bounds.records_max, bounds.bytes_max);
  GiveTurns(old_, filling, bounds.records_max, bounds.bytes_max);
  return filling.oldest;
}

void EntryQueue::GiveTurns(Certificates& from, Filling& filling, std::size_t records_max,
                           std::size_t bytes_max) {
  // Lines that may not go into this batch, until the end of this look.
  Lines passed;
  Certificates done;
  const auto full = [&] {
    return filling.batch.entries() >= records_max || filling.bytes >= bytes_max ||
           passed.size() >= kPassedMax;
  };
  while (!from.empty() && !full()) {
    const auto turn = from.begin();
    const bool moved = GiveTurn(*turn, filling, passed);
    Certificates& to = !moved || turn->lines.empty() ? done : old_;
    to.splice(to.end(), from, turn);
  }
  while (!passed.empty()) {
    Lines& lines = passed.front().certificate->lines;
    lines.splice(lines.end(), passed, passed.begin());
  }
  for (auto certificate = done.begin(); certificate != done.end();) {
    const auto at = certificate++;
    if (!at->lines.empty()) continue;
    gateways_.erase(at->gateway.get());
    done.erase(at);
  }
  old_.splice(old_.end(), done);
}

bool EntryQueue::GiveTurn(Certificate& certificate, Filling& filling, Lines& passed) {
  using Admission = BatchShares::Admission;
  Lines& lines = certificate.lines;
  while (!lines.empty() && passed.size() < kPassedMax) {
    const auto line = lines.begin();
    const Origin& next = line->entries.front().origin;
    const auto admission =
        filling.held.MayCommit(next) ? filling.shares.Admit(next) : Admission::kRobotWaits;
    // A robot may wait in a gateway's line and come by another one now.
    if (admission == Admission::kGatewayWaits && next.place.gateway() == certificate.gateway) {
      return false;
    }
    if (admission != Admission::kAdmitted) {
      passed.splice(passed.end(), lines, line);
      continue;
    }
    const auto* const robot = next.client.get();
    filling.AddMessage(line->entries);
    if (line->entries.empty()) {
      lines_.erase(robot);
      lines.erase(line);
    } else {
      lines.splice(lines.end(), lines, line);
    }
    return true;
  }
  return false;
}

std::optional<SteadyTime> EntryQueue::oldest() const {
  std::optional<SteadyTime> oldest;
  for (const auto& [robot, line] : lines_) {
    const SteadyTime arrived = line->entries.front().origin.arrived;
    if (!oldest || arrived < *oldest) oldest = arrived;
  }
  return oldest;
}

}  // namespace uplink::journal
