#include "server/rpc/watch_call.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <absl/status/statusor.h>

#include "server/http/guard.h"
#include "server/http/handlers.h"
#include "server/loop/wake.h"
#include "server/rpc/callers.h"
#include "server/rpc/query_text.h"
#include "server/view/json.h"
#include "server/view/message_wire.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::rpc {
namespace {

using Messages = std::vector<transport::SharedMessage>;

absl::StatusOr<view::WatchQuery> QueryFrom(std::string_view bytes, const identity::Caller& caller) {
  v1::WatchRobotsRequest request;
  if (!request.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return absl::InvalidArgumentError("the request is no uplink.v1.WatchRobotsRequest");
  }
  v1::ListRobotsRequest& filter = *request.mutable_filter();
  filter.clear_page_size();
  filter.clear_page_token();
  filter.clear_order_by();
  // These two stand beside the filter.
  filter.set_fleet(request.fleet());
  *filter.mutable_parts() = request.parts();
  std::string text = QueryOf(filter);
  for (const std::string& ruri : request.ruris()) AppendParameter("ruri", ruri, text);
  auto query = http::WatchQueryOf({.query = std::move(text), .caller = caller});
  if (const auto* refusal = std::get_if<http::Response>(&query)) return StatusOf(*refusal);
  return std::get<view::WatchQuery>(std::move(query));
}

absl::StatusOr<std::string> WireOf(const view::WatchChange& change) {
  std::string wire;
  if (const auto* shown = std::get_if<view::RobotShown>(&change)) {
    const auto robot = view::Encode(view::Form::kWire, (*shown)->view(), (*shown)->parts());
    if (!robot.ok()) return robot.status();
    view::AppendField(v1::RobotChange::kRobotFieldNumber, *robot, wire);
    return wire;
  }
  v1::RobotChange message;
  if (const auto* removed = std::get_if<view::RobotRemoved>(&change)) {
    message.set_removed(removed->ruri);
  } else {
    message.mutable_snapshot_end()->set_robots(std::get<view::SnapshotShown>(change).robots);
  }
  return message.SerializeAsString();
}

absl::StatusOr<Messages> MessagesOf(const std::vector<view::WatchChange>& changes) {
  Messages messages;
  messages.reserve(changes.size());
  for (const view::WatchChange& change : changes) {
    auto wire = WireOf(change);
    if (!wire.ok()) return wire.status();
    messages.push_back(std::make_shared<const std::string>(*std::move(wire)));
  }
  return messages;
}

/// Tells the call that there is something to take. The watch holds it, which may ring it once more
/// when all others are gone.
struct Bell {
  explicit Bell(loop::StreamRef rings) : call(std::move(rings)) {}

  const loop::StreamRef call;
  /// Something may be there since Take returned nothing.
  std::atomic<bool> rung{false};
};

}  // namespace

/// What the call shares with the job that takes changes. One such job runs at a time.
struct WatchCall::Feed {
  Feed(view::Watches& given, view::WatchQuery asked, loop::StreamRef call)
      : watches(given), query(std::move(asked)), bell(std::make_shared<Bell>(std::move(call))) {}

  ~Feed() {
    if (watch != nullptr) watch->NoteEnd(end);
  }
  Feed(const Feed&) = delete;
  Feed& operator=(const Feed&) = delete;

  absl::StatusOr<Messages> TakeSome() {
    if (watch == nullptr) {
      auto begun = watches.Begin(std::move(query), [bell = bell] {
        bell->rung = true;
        bell->call.Wake();
      });
      if (!begun.ok()) return begun.status();
      watch = *std::move(begun);
    }
    const auto changes = watch->Take();
    if (!changes.ok()) return changes.status();
    return MessagesOf(*changes);
  }

  view::Watches& watches;
  /// Until the watch has begun.
  view::WatchQuery query;
  const std::shared_ptr<Bell> bell;
  std::atomic<bool> unwanted{false};
  /// Why the call ended.
  std::atomic<view::WatchEnd> end{view::WatchEnd::kLeft};
  /// Of the job.
  std::unique_ptr<view::Watch> watch;
  std::mutex mutex;
  /// What the job took, for the call.
  std::optional<absl::StatusOr<Messages>> taken;
};

WatchCall::WatchCall(const Context& context, transport::ServedCall& call, identity::Caller caller)
    : context_(context), call_(call), caller_(std::move(caller)) {}

WatchCall::~WatchCall() {
  if (feed_ != nullptr) feed_->unwanted = true;
}

void WatchCall::Start() {
  look_at_ = context_.clock.Steady() + kRequestWait;
  call_.RequestMessage();
}

void WatchCall::OnMessage(std::string_view bytes) {
  auto query = QueryFrom(bytes, caller_);
  if (!query.ok()) return Finish(query.status());
  judge_at_ = context_.clock.Steady() + http::kCallerJudgedEvery;
  feed_ = std::make_shared<Feed>(context_.watches, *std::move(query), call_.self());
  Take();
}

void WatchCall::OnTooLarge(std::uint64_t /*bytes*/) {
  Finish(absl::ResourceExhaustedError("the request is too large"));
}

void WatchCall::Take() {
  if (over_) return;
  idle_ = false;
  look_at_.reset();
  const bool posted = context_.post(http::Lane::kWatch, [feed = feed_] {
    if (feed->unwanted) return;
    auto taken = feed->TakeSome();
    {
      const std::lock_guard lock(feed->mutex);
      feed->taken = std::move(taken);
    }
    feed->bell->call.Wake();
  });
  if (!posted) look_at_ = context_.clock.Steady() + kWatchTryAgain;
}

void WatchCall::OnWake() {
  if (over_ || feed_ == nullptr) return;
  std::optional<absl::StatusOr<Messages>> taken;
  {
    const std::lock_guard lock(feed_->mutex);
    std::swap(taken, feed_->taken);
  }
  if (taken) {
    if (!taken->ok()) return Finish(taken->status());
    if (!(*taken)->empty()) return call_.Write(**std::move(taken));
    idle_ = true;
  }
  if (idle_ && feed_->bell->rung.exchange(false)) Take();
}

std::optional<SteadyTime> WatchCall::deadline() const {
  if (!look_at_) return judge_at_;
  return judge_at_ ? std::min(*look_at_, *judge_at_) : look_at_;
}

void WatchCall::OnTimer() {
  if (over_) return;
  const SteadyTime now = context_.clock.Steady();
  if (judge_at_ && now >= *judge_at_) {
    judge_at_ = now + http::kCallerJudgedEvery;
    if (!context_.may_go_on()) {
      return Finish(absl::UnauthenticatedError("the caller may not watch any more"),
                    view::WatchEnd::kDenied);
    }
  }
  if (!look_at_ || now < *look_at_) return;
  if (feed_ != nullptr) return Take();
  Finish(absl::DeadlineExceededError("the request did not come whole in time"));
}

void WatchCall::OnDrain(milliseconds /*grace*/) {
  Finish(absl::UnavailableError("the connection ends; watch again"), view::WatchEnd::kDrained);
}

void WatchCall::OnBroken(const transport::Ending& /*ending*/) {
  over_ = true;
  if (feed_ != nullptr) feed_->unwanted = true;
}

void WatchCall::Finish(const absl::Status& status, view::WatchEnd why) {
  over_ = true;
  look_at_.reset();
  judge_at_.reset();
  if (feed_ != nullptr) {
    feed_->end = why;
    feed_->unwanted = true;
  }
  call_.Finish(status);
}

}  // namespace uplink::rpc
