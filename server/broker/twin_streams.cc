#include "server/broker/twin_streams.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "server/broker/limits.h"
#include "server/cyberwave/whose.h"
#include "storage/origin.h"

namespace uplink::broker {

using transport::EndCause;

namespace {

using cyberwave::RobotKind;

/// The twin of a RURI under one of the prefixes; empty if there is none.
std::optional<TwinStreams::Named> NamedBy(const std::string& ruri,
                                          const std::vector<std::string>& prefixes) {
  const std::size_t slash = ruri.rfind('/');
  if (slash == std::string::npos) return std::nullopt;
  const auto id = model::cyberwave::Uuid::FromText(std::string_view(ruri).substr(slash + 1));
  if (!id) return std::nullopt;
  for (const std::string& prefix : prefixes) {
    for (const RobotKind kind : {RobotKind::kReal, RobotKind::kSimulated}) {
      if (cyberwave::TwinRuri(prefix, *id, kind) == ruri) {
        return TwinStreams::Named{.ruri = ruri, .prefix = prefix, .twin = *id};
      }
    }
  }
  return std::nullopt;
}

}  // namespace

TwinStream* TwinStreams::Find(const std::string& ruri) {
  const auto found = streams_.find(ruri);
  return found == streams_.end() ? nullptr : found->second.get();
}

TwinStream* TwinStreams::FindById(std::uint64_t id) {
  const auto found = by_id_.find(id);
  return found == by_id_.end() ? nullptr : found->second;
}

TwinStreams::Opened TwinStreams::FindOrOpen(const Named& named) {
  if (context_.fleet.entry().IsBlocked(named.ruri)) return {.blocked = true};
  if (TwinStream* stream = Find(named.ruri)) {
    if (stream->ended) return {};
    if (stream->robot->kept_out()) return {.blocked = true};
    if (!Revive(*stream)) return {.too_many = true};
    return {.stream = stream};
  }
  if (const auto rests = rests_.find(named.ruri); rests != rests_.end()) {
    if (context_.clock.Steady() < rests->second) return {};
    rests_.erase(rests);
  }
  cyberwave::TwinPtr twin = context_.twins.FindOrAdd(named.ruri, named.twin);
  if (twin == nullptr) return {.too_many = true};
  auto robot = context_.fleet.FindOrAdmit({.ruri = named.ruri, .fleet = context_.fleet_name});
  if (!robot.ok()) {
    context_.twins.Remove(named.ruri);
    return {.too_many = absl::IsResourceExhausted(robot.status()),
            .blocked = absl::IsPermissionDenied(robot.status())};
  }
  TwinStream* stream = Open(*std::move(robot), std::move(twin));
  if (stream != nullptr) stream->rates = RatesOf(named);
  return {.stream = stream};
}

std::optional<TwinStreams::Opened> TwinStreams::PlaceOf(const cyberwave::Judgement& judgement) {
  const cyberwave::Topic& topic = judgement.topic;
  if (cyberwave::RobotOf(judgement).has_value()) {
    const std::string ruri = cyberwave::RuriOf(judgement);
    if (TwinStream* stream = Find(ruri); stream != nullptr && !stream->ending && !stream->ended) {
      if (stream->robot->kept_out()) return Opened{.blocked = true};
      return Opened{.stream = stream};
    }
    if (context_.fleet.entry().IsBlocked(ruri)) return Opened{.blocked = true};
    const bool durable = judgement.message_class == cyberwave::MessageClass::kDurable;
    const bool speaks = cyberwave::SignOfLifeOf(judgement) == cyberwave::RobotOf(judgement) ||
                        (durable && judgement.rejection() == nullptr);
    // Messages that only command or watch a twin do not prove that it exists.
    if (speaks || context_.fleet.Find(ruri) != nullptr) {
      return FindOrOpen({.ruri = ruri, .prefix = topic.prefix, .twin = topic.id});
    }
    if (judgement.rejection() == nullptr) return std::nullopt;
  }
  return FindOrOpenStandIn(topic.prefix);
}

TwinStreams::Opened TwinStreams::FindOrOpenStandIn(const std::string& prefix) {
  const std::string name = storage::NoRobotOf(prefix);
  if (TwinStream* stream = Find(name)) {
    stream->ending = false;
    return {.stream = stream};
  }
  auto robot = std::make_shared<robot::Robot>(std::make_shared<const model::RobotId>(model::RobotId{
                                                  .ruri = name, .fleet = context_.fleet_name}),
                                              context_.clock.Steady(), context_.clock, untold_);
  TwinStream* stream = Open(std::move(robot), nullptr);
  if (stream != nullptr) stream->rates = std::make_shared<cyberwave::TwinRates>();
  return {.stream = stream};
}

TwinStream* TwinStreams::Open(fleet::RobotPtr robot, cyberwave::TwinPtr twin) {
  const SteadyTime now = context_.clock.Steady();
  auto stream = std::make_unique<TwinStream>();
  stream->id = ++last_id_;
  stream->self = {.inbox = &context_.inbox, .stream = stream->id};
  stream->session = DrawSession();
  stream->used_at = now;
  robot->NoteHeard(context_.clock.System());
  static_cast<void>(robot->sessions.Attach(stream->self, now, context_.clock.System()));
  if (twin != nullptr) context_.fleet.Keep(*robot);
  const auto begun = robot->sessions.Begin(stream->session, now, {.fleet = context_.fleet_name});
  if (!begun) {
    static_cast<void>(robot->sessions.Detach(stream->self, now));
    return nullptr;
  }
  stream->generation = begun->generation;
  robot->state.Claim(now);
  stream->journal = &context_.journals.Of(robot->ruri());
  stream->journal->Open(*robot, begun->open_id,
                        {.robot = robot->id(),
                         .session = stream->session,
                         .at = context_.clock.System(),
                         .sessions_held = robot->sessions.Held(),
                         .fleet_word = begun->fleet_word});
  robot->state.BeginStream();
  // The session was drawn just now, so the store has nothing of it.
  static_cast<void>(robot->sessions.ResumeFrom(stream->session, begun->open_id, 0, 0));
  if (twin != nullptr) {
    RestoreFaults(*twin);
    if (rereading_) unsure_.insert(twin->ruri());
  }
  stream->robot = std::move(robot);
  stream->twin = std::move(twin);
  TwinStream* opened = stream.get();
  by_id_.emplace(opened->id, opened);
  streams_.emplace(opened->ruri(), std::move(stream));
  return opened;
}

model::SessionId TwinStreams::DrawSession() const {
  constexpr std::size_t kBytesOfNumber = sizeof(std::uint64_t);
  std::array<std::uint8_t, model::SessionId::kBytes> bytes{};
  for (std::size_t at = 0; at < bytes.size(); at += kBytesOfNumber) {
    const std::uint64_t drawn = context_.random();
    for (std::size_t i = 0; i < kBytesOfNumber; ++i) {
      bytes[at + i] = static_cast<std::uint8_t>(drawn >> (8 * i));
    }
  }
  return model::SessionId(bytes);
}

std::shared_ptr<cyberwave::TwinRates> TwinStreams::RatesOf(const Named& named) {
  std::weak_ptr<cyberwave::TwinRates>& kept =
      rates_[cyberwave::TwinRuri(named.prefix, named.twin, RobotKind::kReal)];
  std::shared_ptr<cyberwave::TwinRates> rates = kept.lock();
  if (rates == nullptr) kept = rates = std::make_shared<cyberwave::TwinRates>();
  return rates;
}

void TwinStreams::RestoreFaults(cyberwave::Twin& twin) {
  const auto before = faults_.find(twin.ruri());
  if (before == faults_.end()) return;
  twin.RestoreFaults(before->second);
  faults_.erase(before);
}

void TwinStreams::OpenKnown(const std::vector<std::string>& prefixes, Which which) {
  for (const fleet::RobotPtr& robot : context_.fleet.All()) {
    if (robot->source() != model::MessageSource::kCyberwave || robot->leaving()) continue;
    if (which == Which::kNotHeld && robot->state.held_since() != 0) continue;
    if (const auto named = NamedBy(robot->ruri(), prefixes)) static_cast<void>(FindOrOpen(*named));
  }
}

void TwinStreams::Close(TwinStream& stream, EndCause cause) {
  EndConnections(stream, cause);
  robot::Robot& robot = *stream.robot;
  robot.NoteHeard(context_.clock.System());
  static_cast<void>(robot.sessions.Detach(stream.self, context_.clock.Steady()));
  robot.state.EndClaim();
  by_id_.erase(stream.id);
  streams_.erase(streams_.find(std::string(stream.ruri())));
}

void TwinStreams::Drop(TwinStream& stream) {
  EndConnections(stream, EndCause::kForgotten);
  if (stream.twin != nullptr) {
    context_.twins.Remove(stream.ruri());
    rests_[stream.ruri()] = context_.clock.Steady() + kRestAfterDrop;
  }
  Close(stream);
}

void TwinStreams::Lose(TwinStream& stream) {
  if (stream.twin != nullptr) {
    context_.twins.Remove(stream.ruri());
    unsure_.insert(stream.ruri());
  }
  Close(stream);
}

void TwinStreams::SetFaults(FaultsByRobot faults) {
  faults_ = std::move(faults);
  rereading_ = false;
  const std::unordered_set<std::string> unsure = std::exchange(unsure_, {});
  for (const cyberwave::TwinPtr& twin : context_.twins.All()) {
    if (Find(twin->ruri()) != nullptr && !unsure.contains(twin->ruri())) continue;
    twin->RestoreFaults({});
    RestoreFaults(*twin);
  }
  std::erase_if(faults_,
                [this](const auto& each) { return context_.twins.Find(each.first) != nullptr; });
}

bool TwinStreams::Revive(TwinStream& stream) {
  if (!stream.ending) return true;
  model::cyberwave::Uuid id;
  stream.twin->LookAt([&id](const cyberwave::TwinParts& parts) { id = parts.twin; });
  // The twin was forgotten when its stream began to end.
  cyberwave::TwinPtr twin = context_.twins.FindOrAdd(stream.ruri(), id);
  if (twin == nullptr) return false;
  stream.ending = false;
  if (twin == stream.twin) return true;
  RestoreFaults(*twin);
  stream.twin = std::move(twin);
  return true;
}

void TwinStreams::CloseIdle() {
  const SteadyTime now = context_.clock.Steady();
  std::vector<TwinStream*> idle;
  for (const auto& [ruri, stream] : streams_) {
    if (context_.reports != nullptr) {
      stream->connections.EndSilent(*context_.reports, *stream->robot, now, heard_all_since_);
    }
    if (stream->waiting.empty() && now - stream->used_at >= kStreamIdleMax) {
      idle.push_back(stream.get());
    }
  }
  for (TwinStream* stream : idle) Close(*stream);
  std::erase_if(rates_, [](const auto& kept) { return kept.second.expired(); });
  std::erase_if(rests_, [now](const auto& rest) { return rest.second <= now; });
}

void TwinStreams::ForgetLeft() {
  for (const cyberwave::TwinPtr& twin : context_.twins.All()) {
    if (Find(twin->ruri()) != nullptr || context_.fleet.Find(twin->ruri()) != nullptr) continue;
    Forget(*twin);
  }
}

void TwinStreams::Forget(const cyberwave::Twin& twin) {
  // Its next metrics may clear these faults.
  std::vector<std::string> active = twin.ActiveFaults();
  const std::size_t kept_max = kFaultsKeptShare * context_.twins.twins_max();
  if (!active.empty() && faults_.size() < kept_max) faults_[twin.ruri()] = std::move(active);
  context_.twins.Remove(twin.ruri());
}

void TwinStreams::EndAll(EndCause cause) {
  std::vector<TwinStream*> idle;
  for (const auto& [ruri, stream] : streams_) {
    stream->ending = true;
    EndConnections(*stream, cause);
    if (stream->waiting.empty()) idle.push_back(stream.get());
  }
  for (TwinStream* stream : idle) Close(*stream);
}

}  // namespace uplink::broker
