#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "schema/model/rejection.h"
#include "tools/uplink-fleet/compare/compare_twin_rows.h"

// What was wrong on purpose, against the quarantine.
namespace uplink::synthetic {
namespace {

constexpr const char* kSource = "cyberwave";

std::string Text(std::string_view reason, std::string_view topic, std::int64_t bytes,
                 std::string_view source) {
  return fmt::format("{} on {}, {} bytes, source {}", reason, topic, bytes, source);
}

std::string Text(const v1::Quarantined& row) {
  return Text(row.reason(), row.topic(), row.payload_bytes(), row.source());
}

std::string Text(const SentWrong& wrong) {
  return Text(model::ToText(wrong.reason), wrong.topic, static_cast<std::int64_t>(wrong.bytes),
              kSource);
}

/// The number of the twin's empty message, which has no mark, if it may be this one.
std::optional<std::uint64_t> EmptyIn(const TwinScript& twin, const v1::Quarantined& row) {
  if (row.payload_bytes() != 0) return std::nullopt;
  for (const auto& [number, wrong] : twin.account().wrongs()) {
    if (wrong.bytes == 0 && wrong.topic == row.topic()) return number;
  }
  return std::nullopt;
}

/// The server keeps the payload of one rejection per second and reason.
bool IsThinned(const v1::Quarantined& row) {
  return row.payload().empty() && row.payload_bytes() > 0;
}

/// Goes through rows of quarantine. Confined to one comparison.
class FoundWrongs final {
 public:
  FoundWrongs(const TwinScript& twin, Findings& findings) : twin_(twin), findings_(findings) {}

  /// A row of the twin's own robot, or of nobody's.
  void Add(const v1::Quarantined& row, bool of_no_robot) {
    if (IsThinned(row)) return;
    std::optional<std::uint64_t> number = MarkIn(twin_.options(), row.payload());
    if (!number && !of_no_robot) number = EmptyIn(twin_, row);
    if (!number) {
      // Nobody's rows are of all twins; what has a mark of another run is its own.
      const bool foreign = of_no_robot || row.payload().find('~') != std::string::npos;
      if (!foreign) Differ("only what is wrong on purpose", Text(row));
      return;
    }
    const auto& wrongs = twin_.account().wrongs();
    const auto sent = wrongs.find(*number);
    if (sent == wrongs.end()) {
      return Differ(fmt::format("number {} was right", *number), Text(row));
    }
    findings_.Find(Thing::kTwinQuarantine);
    ++counts_[*number];
    if (sent->second.of_no_robot != of_no_robot) {
      return Differ(fmt::format("number {} {}", *number,
                                sent->second.of_no_robot ? "of no robot" : "of this robot"),
                    Text(row));
    }
    if (Text(row) != Text(sent->second)) {
      Differ(fmt::format("number {}: {}", *number, Text(sent->second)), Text(row));
    }
  }

  /// Rows whose payload the server dropped have no mark: each stands for one message that is still
  /// missing and that it describes. Those of nobody's are taken out, since another twin may lack
  /// one like it; one of the robot's own that nothing lacks is told.
  void AddThinned(std::vector<v1::Quarantined> own, std::vector<v1::Quarantined>& nobody) {
    std::erase_if(own, [](const v1::Quarantined& row) { return !IsThinned(row); });
    for (const auto& each : twin_.account().wrongs()) {
      const std::uint64_t number = each.first;
      const SentWrong& wrong = each.second;
      if (counts_[number] > 0) continue;
      std::vector<v1::Quarantined>& rows = wrong.of_no_robot ? nobody : own;
      const auto row = std::ranges::find_if(rows, [&wrong](const v1::Quarantined& stored) {
        return IsThinned(stored) && Text(stored) == Text(wrong);
      });
      if (row == rows.end()) continue;
      findings_.Find(Thing::kTwinQuarantine);
      ++counts_[number];
      rows.erase(row);
    }
    for (const v1::Quarantined& row : own) Differ("only what is wrong on purpose", Text(row));
  }

  /// Past the bound of a robot its oldest rows go, and are counted.
  void CheckCounts(std::int64_t dropped) {
    for (const auto& [number, wrong] : twin_.account().wrongs()) {
      const Delivery delivery = twin_.account().DeliveryOf(number);
      if (MustBeThere(delivery)) findings_.Expect(Thing::kTwinQuarantine);
      const std::string differs = WrongCount(delivery, counts_[number]);
      if (differs.empty() || (dropped > 0 && counts_[number] == 0)) continue;
      Differ(fmt::format("number {}: {} once", number, Text(wrong)), differs);
    }
  }

 private:
  void Differ(std::string expected, std::string found) {
    findings_.Differ(Thing::kTwinQuarantine, twin_.ids().ruri, std::move(expected),
                     std::move(found));
  }

  const TwinScript& twin_;
  Findings& findings_;
  std::map<std::uint64_t, std::size_t> counts_;
};

}  // namespace

void CompareTwinQuarantine(const TwinScript& twin, const StoredTwin& stored,
                           std::vector<v1::Quarantined>& nobody, Findings& findings) {
  FoundWrongs wrongs(twin, findings);
  for (const v1::Quarantined& row : stored.Of(Side::kReal).quarantine) wrongs.Add(row, false);
  for (const v1::Quarantined& row : nobody) wrongs.Add(row, true);
  for (const v1::Quarantined& row : stored.Of(Side::kSim).quarantine) {
    findings.Differ(Thing::kTwinQuarantine, twin.ids().sim_ruri, "nothing of it is wrong",
                    Text(row));
  }
  const auto& own = stored.Of(Side::kReal).quarantine;
  wrongs.AddThinned({own.begin(), own.end()}, nobody);
  wrongs.CheckCounts(stored.Of(Side::kReal).quarantine_dropped);
}

}  // namespace uplink::synthetic
