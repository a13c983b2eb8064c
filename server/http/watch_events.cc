#include "server/http/watch_events.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <absl/status/statusor.h>
#include <fmt/core.h>
#include <fmt/format.h>

#include "server/http/errors.h"
#include "server/http/event_stream.h"
#include "server/view/error_json.h"
#include "server/view/message_printer.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::http {
namespace {

/// What a watch calls; it may outlive that, and be called before there is someone to tell.
class Bell final {
 public:
  void OnRing(std::function<void()> ready) {
    const std::lock_guard lock(mutex_);
    ready_ = std::move(ready);
  }
  void Ring() const {
    std::function<void()> ready;
    {
      const std::lock_guard lock(mutex_);
      ready = ready_;
    }
    if (ready) ready();
  }

 private:
  mutable std::mutex mutex_;
  std::function<void()> ready_;
};

absl::StatusOr<std::string> JsonOf(const view::RobotShown& robot) {
  const absl::StatusOr<std::string>& json = robot->json();
  if (!json.ok()) return json.status();
  return fmt::format(R"({{"robot":{}}})", *json);
}

absl::StatusOr<std::string> JsonOf(const view::RobotRemoved& removed) {
  v1::RobotChange change;
  change.set_removed(removed.ruri);
  return view::MessagePrinter().Print(change);
}

absl::StatusOr<std::string> JsonOf(const view::SnapshotShown& snapshot) {
  v1::SnapshotEnd end;
  end.set_robots(snapshot.robots);
  const absl::StatusOr<std::string> json = view::MessagePrinter().Print(end);
  if (!json.ok()) return json.status();
  return fmt::format(R"({{"snapshotEnd":{}}})", *json);
}

/// By the place of an alternative in view::WatchChange.
constexpr std::string_view kNames[] = {"robot", "removed", "snapshotEnd"};
static_assert(std::size(kNames) == std::variant_size_v<view::WatchChange>);
constexpr std::string_view kEnd = "end";

/// A watch's changes as events. Their ids count from 1 on each connection: an id of another one is
/// unknown, so every connection begins with a snapshot.
class WatchEvents final : public EventStream {
 public:
  WatchEvents(std::unique_ptr<view::Watch> watch, std::shared_ptr<Bell> bell, std::string caller)
      : watch_(std::move(watch)), bell_(std::move(bell)), caller_(std::move(caller)) {}

  Taken Take() override {
    Taken taken;
    const absl::StatusOr<std::vector<view::WatchChange>> changes = watch_->Take();
    if (!changes.ok()) return End(changes.status());
    for (const view::WatchChange& change : *changes) {
      const absl::StatusOr<std::string> json =
          std::visit([](const auto& each) { return JsonOf(each); }, change);
      if (!json.ok()) return End(absl::InternalError("the server failed"));
      Add(kNames[change.index()], *json, taken.text);
    }
    return taken;
  }
  void OnReady(std::function<void()> ready) override { bell_->OnRing(std::move(ready)); }
  [[nodiscard]] const std::string& caller() const override { return caller_; }
  void NoteDenied() override { watch_->NoteEnd(view::WatchEnd::kDenied); }

 private:
  Taken End(const absl::Status& why) {
    Taken taken{.text = {}, .over = true};
    const std::string code = absl::StatusCodeToString(why.code());
    const std::string message(why.message());
    Add(kEnd, view::ErrorJson({.code = code, .message = message}), taken.text);
    return taken;
  }
  /// JSON has no line breaks of its own.
  void Add(std::string_view name, std::string_view json, std::string& text) {
    fmt::format_to(std::back_inserter(text), "id: {}\nevent: {}\ndata: {}\n\n", ++id_, name, json);
  }

  const std::unique_ptr<view::Watch> watch_;
  const std::shared_ptr<Bell> bell_;
  const std::string caller_;
  std::uint64_t id_ = 0;
};

}  // namespace

std::string WatcherOf(const identity::Caller& caller) {
  switch (caller.proof) {
    case identity::Proof::kNone:
      break;
    case identity::Proof::kToken:
      return "token " + caller.name;
    case identity::Proof::kCertificate:
      return "certificate " + caller.name;
  }
  return {};
}

Response WatchResponse(view::Watches& watches, view::WatchQuery query) {
  auto bell = std::make_shared<Bell>();
  std::string caller = query.caller;
  auto watch = watches.Begin(std::move(query), [bell] { bell->Ring(); });
  if (!watch.ok()) return TooManyWatches(std::string(watch.status().message()));
  Response response;
  response.content_type = "text/event-stream";
  response.events =
      std::make_shared<WatchEvents>(*std::move(watch), std::move(bell), std::move(caller));
  return response;
}

}  // namespace uplink::http
