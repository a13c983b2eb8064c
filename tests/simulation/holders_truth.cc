#include "tests/simulation/holders_truth.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "server/store/lease_judge.h"

namespace uplink::simulation {
namespace {

/// The id of no process: all robots are of others.
constexpr storage::ProcessId kNobody{};

std::string NameOf(const storage::ProcessId& process) {
  return fmt::format("{}.{}", process[0], process[1]);
}

}  // namespace

std::map<std::string, HoldersTruth::Hold> HoldersTruth::Holds() const {
  std::map<std::string, Hold> holds;
  for (const storage::ForeignRobot& robot : database_.RobotsOfOthers(kNobody, "")) {
    holds[robot.robot.ruri] = {robot.holder, robot.held_since};
  }
  return holds;
}

void HoldersTruth::NoteEnded(const storage::ProcessId& process, End end) {
  ended_.try_emplace(process, Ended{end, clock_.Steady()});
}

void HoldersTruth::NoteSign(const std::string& ruri, const storage::ProcessId& process,
                            storage::Epoch held_since) {
  Robot& robot = robots_[ruri];
  if (robot.lost.contains({process, held_since})) {
    robot.signs.push_back(clock_.System());
    return;
  }
  if (held_since == 0 || held_since < robot.opened_since) return;
  const std::map<std::string, Hold> holds = Holds();
  const auto hold = holds.find(ruri);
  if (hold == holds.end()) return;
  if (hold->second.holder != process && !robot.began.formers.contains(process)) return;
  robot.signs.push_back(clock_.System());
}

void HoldersTruth::NoteSignAtCut(const std::string& ruri, const storage::ProcessId& process) {
  if (renewed_.contains(process)) robots_[ruri].signs.push_back(clock_.System());
}

milliseconds HoldersTruth::RenewedAgo(const storage::ProcessId& process) const {
  const auto renewed = renewed_.find(process);
  if (renewed == renewed_.end()) return milliseconds(0);
  return std::chrono::duration_cast<milliseconds>(clock_.Steady() - renewed->second);
}

void HoldersTruth::OnOpened(const storage::ProcessId& process, const std::string& ruri,
                            const std::map<std::string, Hold>& before,
                            const HasStream& has_stream) {
  const Hold hold = Holds()[ruri];
  Robot& robot = robots_[ruri];
  robot.opened_since = hold.since;
  robot.lost.clear();
  robot.begun.emplace(process, hold.since);
  robot.began.opened = true;
  const auto was = before.find(ruri);
  if (was != before.end() && was->second.since == hold.since) return;
  robot.began = {.at = clock_.Steady()};
  Tell(fmt::format("{} opened {} since {}", NameOf(process), ruri, hold.since));
  if (was == before.end() || has_stream(ruri)) return;
  const std::vector<storage::Lease> leases = database_.ReadLeases();
  const auto lease = std::ranges::find(leases, was->second.holder, &storage::Lease::process);
  if (lease == leases.end() || lease->released) return;
  Fail(fmt::format("{} took {} from {} for a stream that had ended", NameOf(process), ruri,
                   NameOf(was->second.holder)));
}

void HoldersTruth::OnAdopted(const storage::ProcessId& process,
                             const std::map<std::string, Hold>& before) {
  for (const auto& [ruri, hold] : Holds()) {
    const auto was = before.find(ruri);
    if (was == before.end() || was->second.since == hold.since) continue;
    const storage::ProcessId& former = was->second.holder;
    ++adoptions_;
    Tell(fmt::format("{} adopted {} of {} since {}", NameOf(process), ruri, NameOf(former),
                     hold.since));
    CheckOver(ruri, former);
    Robot& robot = robots_[ruri];
    robot.begun.emplace(process, hold.since);
    // A chain of adoptions: what any of its holders hears is a sign of life.
    robot.began.chained = robot.began.adopted;
    robot.began.adopted = true;
    // A process that heard it before that stream does not count any more.
    if (std::exchange(robot.began.opened, false)) robot.began.formers.clear();
    robot.began.at = clock_.Steady();
    robot.began.system_at = clock_.System();
    robot.began.from = former;
    robot.began.formers.insert(former);
    robot.began.ended_fresh.reset();
    const auto ended = ended_.find(former);
    const auto renewed = renewed_.find(former);
    if (ended == ended_.end() || renewed == renewed_.end()) continue;
    if (ended->second.at - renewed->second <= kFresh) robot.began.ended_fresh = ended->second.how;
  }
}

bool HoldersTruth::MayBeHeardAtFormer(const std::string& ruri, const storage::ProcessId& holder) {
  const Began& began = robots_[ruri].began;
  return began.adopted && !began.opened &&
         std::ranges::any_of(began.formers, [&](const auto& former) {
           return former != holder && !ended_.contains(former);
         });
}

void HoldersTruth::CheckOver(const std::string& ruri, const storage::ProcessId& holder) {
  if (ended_.contains(holder)) return;
  const auto renewed = renewed_.find(holder);
  if (renewed == renewed_.end()) return;
  if (clock_.Steady() - renewed->second >= store::kSilentMax) return;
  Fail(fmt::format("{} was adopted of {}, which lives and had just renewed its lease", ruri,
                   NameOf(holder)));
}

void HoldersTruth::OnWritten(const storage::ProcessId& process, const storage::PresenceItem& item) {
  const std::string& ruri = item.robot->ruri;
  Robot& robot = robots_[ruri];
  Tell(fmt::format("{} wrote {} {} at {}", NameOf(process), ruri, model::ToText(item.presence),
                   UnixMs(item.at)));
  if (Holds()[ruri].holder != process) {
    Fail(fmt::format("{} wrote of {}, which another process holds", NameOf(process), ruri));
  }
  if (!item.changes_presence) return;
  if (!robot.rows.empty() && robot.rows.back().presence == item.presence) {
    Fail(fmt::format("{} has two rows {} in a row", ruri, model::ToText(item.presence)));
  }
  if (!robot.rows.empty() && robot.rows.back().at > item.at) {
    Fail(fmt::format("{} has a row that is older than the one before", ruri));
  }
  if (item.presence == model::Presence::kOffline) CheckSilence(robot, item);
  robot.rows.push_back({item.presence, item.at});
}

void HoldersTruth::CheckSilence(const Robot& robot, const storage::PresenceItem& item) {
  const auto after = std::ranges::upper_bound(robot.signs, item.at);
  if (after == robot.signs.begin() || item.at - *(after - 1) > timeout_) return;
  Fail(fmt::format("{} was called offline {} ms after it was heard", item.robot->ruri,
                   std::chrono::duration_cast<milliseconds>(item.at - *(after - 1)).count()));
}

void HoldersTruth::GoBack(const std::map<std::string, Hold>& before) {
  Tell("the store goes back");
  const std::map<std::string, Hold> after = Holds();
  for (auto& [ruri, robot] : robots_) {
    Robot& copy = copy_[ruri];
    copy.signs = std::move(robot.signs);
    copy.lost = std::move(robot.lost);
    copy.unknowing = std::move(robot.unknowing);
    std::ranges::set_difference(robot.begun, copy.begun,
                                std::inserter(copy.unknowing, copy.unknowing.end()));
    robot = copy;
    const auto was = before.find(ruri);
    const auto is = after.find(ruri);
    if (was == before.end()) continue;
    if (is != after.end() && is->second.since == was->second.since &&
        is->second.holder == was->second.holder) {
      continue;
    }
    robot.lost.emplace(was->second.holder, was->second.since);
  }
}

void HoldersTruth::NoteCompared(const storage::ProcessId& process) {
  for (auto& [ruri, robot] : robots_) {
    std::erase_if(robot.unknowing, [&](const auto& hold) { return hold.first == process; });
  }
}

void HoldersTruth::Fail(std::string what) {
  Tell("FAILED " + what);
  if (violation_.empty()) violation_ = std::move(what);
}

void HoldersTruth::Tell(std::string line) {
  lines_.push_back(fmt::format("{} {}", UnixMs(clock_.System()), line));
}

}  // namespace uplink::simulation
