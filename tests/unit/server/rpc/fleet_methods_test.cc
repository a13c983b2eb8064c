#include "server/rpc/fleet_methods.h"

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <gtest/gtest.h>

#include "grpc/health/v1/health.pb.h"
#include "grpc/reflection/v1/reflection.pb.h"
#include "server/http/routes.h"
#include "server/identity/token_line.h"
#include "server/limits/policies.h"
#include "server/rpc/health_calls.h"
#include "server/rpc/reflection_call.h"
#include "server/rpc/watch_call.h"
#include "tests/support/server_world.h"
#include "uplink/v1/admin.pb.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::rpc {
namespace {

using identity::Role;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::array<std::uint8_t, identity::kTokenRandomBytes> kRandom{7};

/// A call as its handler sees it, without a wire.
class FakeCall final : public transport::ServedCall {
 public:
  explicit FakeCall(transport::CallerProof proof) : proof_(std::move(proof)) {}

  void RequestMessage() override { ++wanted; }
  void Write(std::string message_with_prefix) override {
    written.push_back(message_with_prefix.substr(transport::kPrefixBytes));
  }
  void Write(std::vector<transport::SharedMessage> messages) override {
    for (const auto& message : messages) written.push_back(*message);
  }
  void Finish(const absl::Status& status) override {
    EXPECT_FALSE(end) << "a call ends once";
    end = status;
  }
  void FinishRefused(const absl::Status& status) override { Finish(status); }
  void Cancel() override {}
  void AskPeer() override {}
  [[nodiscard]] const identity::PeerIdentity& peer() const override { return peer_; }
  [[nodiscard]] transport::CallerProof proof() const override { return proof_; }
  [[nodiscard]] std::optional<SteadyTime> give_up_at() const override { return std::nullopt; }
  [[nodiscard]] loop::StreamRef self() const override { return {}; }

  void NoteCaller(std::string_view name) override { caller = name; }
  int wanted = 0;
  std::string caller;
  std::vector<std::string> written;
  std::optional<absl::Status> end;

 private:
  const transport::CallerProof proof_;
  const identity::PeerIdentity peer_;
};

class FleetMethodsTest : public ::testing::Test {
 protected:
  FleetMethodsTest() {
    calls_.post = [this](http::Lane /*lane*/, std::function<void()> job) {
      if (!takes_jobs_) return false;
      jobs_.push_back(std::move(job));
      return true;
    };
    methods_ = FleetMethods({world_.site, guard_, world_.monitor, world_.watches, calls_,
                             world_.rpc_probe})(world_.clock);
    world_.AddRobot("rcan://a", "north");
    world_.AddRobot("rcan://b", "south");
  }

  static transport::CallerProof Of(Role role, std::string fleet = "*") {
    return {.identity = identity::PeerIdentity{.role = role, .fleet = std::move(fleet)},
            .subject = "CN=anna",
            .expiry = FromUnixMs(4'000'000'000'000)};
  }

  /// Of a token for the fleet north, the only one that counts.
  transport::CallerProof OfToken() {
    const identity::NewToken token = identity::MakeToken(kRandom);
    const identity::TokenEntry entry{.id = identity::TokenIdOf(token.hash),
                                     .role = Role::kViewer,
                                     .scope = identity::Scope::Of({"north"}),
                                     .hash = token.hash};
    const auto table = identity::TokenTable::Parse(identity::LineOf(entry), "tokens");
    EXPECT_TRUE(table.ok()) << table.status();
    tokens_ = std::make_shared<const http::Tokens>(http::Tokens{*table, std::nullopt});
    transport::CallerProof proof;
    proof.authorization = "Bearer " + token.token;
    return proof;
  }
  /// Begins a call. Null: it was refused.
  std::unique_ptr<transport::CallHandler> Begin(const std::string& path, FakeCall& call) {
    auto handler = methods_.at(path).serve(call);
    if (!handler.ok()) {
      call.end = handler.status();
      return nullptr;
    }
    (*handler)->Start();
    return *std::move(handler);
  }
  void RunJobs(transport::CallHandler& handler) {
    while (!jobs_.empty()) {
      jobs_.front()();
      jobs_.pop_front();
    }
    handler.OnWake();
  }
  /// The whole of a unary call.
  template <typename Answer, typename Request>
  absl::StatusOr<Answer> Call(const std::string& path, const transport::CallerProof& proof,
                              const Request& request) {
    FakeCall call(proof);
    if (const auto handler = Begin(path, call)) {
      handler->OnMessage(request.SerializeAsString());
      RunJobs(*handler);
    }
    if (!call.end->ok()) return *call.end;
    Answer answer;
    EXPECT_TRUE(answer.ParseFromString(call.written.at(0)));
    return answer;
  }
  template <typename Answer, typename Request>
  absl::StatusOr<Answer> View(const std::string& name, const transport::CallerProof& proof,
                              const Request& request) {
    return Call<Answer>("/uplink.v1.FleetView/" + name, proof, request);
  }

  testing::ServerWorld world_;
  std::shared_ptr<const http::Tokens> tokens_ = std::make_shared<const http::Tokens>();
  http::Guard guard_{{world_.clock, world_.logger, world_.http_probe},
                     {.asks = false, .tokens = [this] { return tokens_; }}};
  UnaryCalls calls_;
  bool takes_jobs_ = true;
  std::deque<std::function<void()>> jobs_;
  transport::Methods methods_;
};

TEST_F(FleetMethodsTest, EachUnaryMethodAndEachPathOfDataHasItsRow) {
  const auto* service = v1::ListRobotsRequest::descriptor()->file()->FindServiceByName("FleetView");
  std::set<std::string_view> paths{"/api/v1/openapi.yaml", "/api/v1/robots/{}", "/api/v1/watch"};
  for (const PathMethod& row : kViewMethods) paths.insert(row.path);
  for (const PathMethod& row : kAdminMethods) paths.insert(row.path);
  int unary = 0;
  for (int i = 0; i < service->method_count(); ++i) {
    if (!service->method(i)->server_streaming()) ++unary;
  }
  EXPECT_EQ(unary, static_cast<int>(kViewMethods.size()));
  for (const http::Route& route : http::Routes()) {
    if (!route.pattern.starts_with("/api/")) continue;
    EXPECT_TRUE(paths.contains(route.pattern)) << route.pattern;
  }
}

TEST_F(FleetMethodsTest, AnswersWhatIsInTheCallersScope) {
  const auto all =
      View<v1::ListRobotsResponse>("ListRobots", Of(Role::kViewer), v1::ListRobotsRequest());
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_EQ(all->robots_size(), 2);
  EXPECT_EQ(all->total(), 2);
  const auto north = View<v1::ListRobotsResponse>("ListRobots", Of(Role::kViewer, "north"),
                                                  v1::ListRobotsRequest());
  ASSERT_TRUE(north.ok()) << north.status();
  ASSERT_EQ(north->robots_size(), 1);
  EXPECT_EQ(north->robots(0).ruri(), "rcan://a");
  v1::GetRobotRequest other;
  other.set_ruri("rcan://b");
  const auto hidden = View<v1::Robot>("GetRobot", Of(Role::kViewer, "north"), other);
  EXPECT_EQ(hidden.status().code(), absl::StatusCode::kNotFound);
}

TEST_F(FleetMethodsTest, EachAnswersACallerOfAllFleets) {
  for (const PathMethod& row : kViewMethods) {
    SCOPED_TRACE(row.name);
    v1::GetRobotRequest robot;
    if (row.name.starts_with("GetRobot")) robot.set_ruri("rcan://a");
    FakeCall call(Of(Role::kAdmin));
    const auto handler = Begin("/uplink.v1.FleetView/" + std::string(row.name), call);
    ASSERT_NE(handler, nullptr);
    handler->OnMessage(robot.SerializeAsString());
    RunJobs(*handler);
    EXPECT_EQ(call.end, absl::OkStatus());
    EXPECT_EQ(call.written.size(), 1U);
  }
}

TEST_F(FleetMethodsTest, CommandsAreThoseOfHttp) {
  v1::NoteRobotRequest note;
  note.set_ruri("rcan://a");
  (*note.mutable_labels())["site"] = "hall 1";
  note.set_note("");
  const auto ask = [this, &note](const transport::CallerProof& proof) {
    return Call<v1::RobotSetting>("/uplink.v1.FleetAdmin/NoteRobot", proof, note);
  };
  const auto set = ask(Of(Role::kOperator, "north"));
  ASSERT_TRUE(set.ok()) << set.status();
  EXPECT_EQ(set->labels().at("site"), "hall 1");
  EXPECT_EQ(ask(Of(Role::kViewer)).status().code(), absl::StatusCode::kPermissionDenied);
  EXPECT_EQ(ask(Of(Role::kOperator, "south")).status().code(), absl::StatusCode::kNotFound);
  note.clear_ruri();
  EXPECT_EQ(ask(Of(Role::kOperator)).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(FleetMethodsTest, CommandsThatComeTooFastAreRefused) {
  v1::DisconnectRobotRequest robot;
  robot.set_ruri("rcan://a");
  const auto ask = [this, &robot] {
    return Call<v1::RobotSetting>("/uplink.v1.FleetAdmin/DisconnectRobot", Of(Role::kOperator),
                                  robot);
  };
  constexpr auto kAtOnce = limits::PolicyOf(limits::PolicyId::kCommandsOfCaller).at_once;
  for (std::uint64_t i = 0; i < kAtOnce; ++i) ASSERT_TRUE(ask().ok()) << i;
  const absl::Status over = ask().status();
  EXPECT_EQ(over.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(over.message()), HasSubstr("5 commands about robots per second"));
}

TEST_F(FleetMethodsTest, RefusesAsHttpDoes) {
  const v1::GetStatusRequest nothing;
  EXPECT_EQ(View<v1::ServerStatus>("GetStatus", {}, nothing).status().code(),
            absl::StatusCode::kUnauthenticated);
  EXPECT_EQ(
      View<v1::ServerStatus>("GetStatus", Of(Role::kViewer, "north"), nothing).status().code(),
      absl::StatusCode::kPermissionDenied);
  const auto robot = View<v1::ServerStatus>("GetStatus", Of(Role::kRobot), nothing);
  EXPECT_EQ(robot.status().code(), absl::StatusCode::kPermissionDenied);
  EXPECT_THAT(std::string(robot.status().message()), HasSubstr("the role robot"));
  v1::ListEventsRequest wrong;
  wrong.set_page_size(-1);
  const auto events = View<v1::ListEventsResponse>("ListEvents", Of(Role::kViewer), wrong);
  EXPECT_EQ(events.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(events.status().message()), HasSubstr("pageSize must be a number"));
}

TEST_F(FleetMethodsTest, WhatIsNoRequestIsRefused) {
  FakeCall call(Of(Role::kViewer));
  const auto handler = Begin("/uplink.v1.FleetView/ListRobots", call);
  ASSERT_NE(handler, nullptr);
  handler->OnMessage("\xFF\xFF");
  EXPECT_EQ(call.end->code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(jobs_, IsEmpty());
}

TEST_F(FleetMethodsTest, ACallThatIsGoneIsNotAnswered) {
  FakeCall call(Of(Role::kViewer));
  auto handler = Begin("/uplink.v1.FleetView/ListRobots", call);
  ASSERT_NE(handler, nullptr);
  handler->OnMessage("");
  handler->OnBroken({});
  handler.reset();
  ASSERT_EQ(jobs_.size(), 1U);
  jobs_.front()();
  EXPECT_EQ(calls_.under_way(), 0U);
  EXPECT_THAT(call.written, IsEmpty());
}

TEST_F(FleetMethodsTest, ThoseThatAreAnsweredAreBounded) {
  std::deque<FakeCall> open;
  std::vector<std::unique_ptr<transport::CallHandler>> handlers;
  const auto ask = [&](const std::string& name) {
    transport::CallerProof proof = Of(Role::kViewer);
    proof.subject = "CN=" + name;
    FakeCall& call = open.emplace_back(std::move(proof));
    handlers.push_back(Begin("/uplink.v1.FleetView/ListRobots", call));
    EXPECT_NE(handlers.back(), nullptr);
    handlers.back()->OnMessage("");
    return call.end;
  };
  for (std::size_t i = 0; i < kUnaryCallsMax; ++i) {
    ASSERT_EQ(ask(std::to_string(i / kUnaryCallsPerCallerMax)), std::nullopt) << i;
  }
  EXPECT_EQ(calls_.under_way(), kUnaryCallsMax);
  EXPECT_EQ(ask("another")->code(), absl::StatusCode::kResourceExhausted);
  handlers.front().reset();
  EXPECT_EQ(ask("another"), std::nullopt);
}

TEST_F(FleetMethodsTest, ACallWithoutItsRequestKeepsNoOtherCallerOut) {
  FakeCall idle(Of(Role::kViewer));
  std::vector<std::unique_ptr<transport::CallHandler>> open;
  for (std::size_t i = 0; i < kUnaryCallsPerCallerMax; ++i) {
    open.push_back(Begin("/uplink.v1.FleetView/ListRobots", idle));
    ASSERT_NE(open.back(), nullptr);
  }
  EXPECT_EQ(calls_.under_way(), 0U);
  EXPECT_EQ(Begin("/uplink.v1.FleetView/ListRobots", idle), nullptr) << "it has its share";
  EXPECT_EQ(idle.end->code(), absl::StatusCode::kResourceExhausted);
  transport::CallerProof other = Of(Role::kViewer);
  other.subject = "CN=berta";
  EXPECT_TRUE(View<v1::ListRobotsResponse>("ListRobots", other, v1::ListRobotsRequest()).ok());
}

TEST_F(FleetMethodsTest, ACallerIsJudgedAgainOnceItsRequestIsThere) {
  const transport::CallerProof proof = OfToken();
  FakeCall call(proof);
  const auto handler = Begin("/uplink.v1.FleetView/ListRobots", call);
  ASSERT_NE(handler, nullptr) << *call.end;
  tokens_ = std::make_shared<const http::Tokens>();
  handler->OnMessage("");
  EXPECT_EQ(call.end->code(), absl::StatusCode::kUnauthenticated);
}

TEST_F(FleetMethodsTest, WhileTooManyWaitForTheStoreACallIsToldToTryAgain) {
  takes_jobs_ = false;
  const auto robots =
      View<v1::ListRobotsResponse>("ListRobots", Of(Role::kViewer), v1::ListRobotsRequest());
  EXPECT_EQ(robots.status().code(), absl::StatusCode::kUnavailable);
}

TEST_F(FleetMethodsTest, ARequestThatDoesNotComeEndsItsCall) {
  FakeCall call(Of(Role::kViewer));
  const auto handler = Begin("/uplink.v1.FleetView/ListRobots", call);
  ASSERT_NE(handler, nullptr);
  world_.clock.Advance(kRequestWait);
  ASSERT_LE(handler->deadline(), world_.clock.Steady());
  handler->OnTimer();
  EXPECT_EQ(call.end->code(), absl::StatusCode::kDeadlineExceeded);
}

TEST_F(FleetMethodsTest, AWatchShowsRobotsAndTheirChanges) {
  FakeCall call(Of(Role::kViewer, "north"));
  const auto watch = Begin("/uplink.v1.FleetView/WatchRobots", call);
  ASSERT_NE(watch, nullptr);
  v1::WatchRobotsRequest request;
  request.mutable_filter()->set_page_size(-1);  // has no meaning here
  watch->OnMessage(request.SerializeAsString());
  RunJobs(*watch);
  const auto changes = [&call] {
    std::vector<v1::RobotChange> read(call.written.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
      EXPECT_TRUE(read[i].ParseFromString(call.written[i]));
    }
    return read;
  };
  ASSERT_EQ(changes().size(), 2U);
  EXPECT_EQ(changes()[0].robot().ruri(), "rcan://a");
  EXPECT_EQ(changes()[1].snapshot_end().robots(), 1);
  watch->OnWritten();
  RunJobs(*watch);
  EXPECT_EQ(changes().size(), 2U) << "nothing has changed";
  EXPECT_EQ(world_.watches.size(), 1U);
  watch->OnDrain({});
  EXPECT_EQ(call.end->code(), absl::StatusCode::kUnavailable);
}

TEST_F(FleetMethodsTest, AWatchShowsTheRobotsThatItNames) {
  for (const auto& [ruri, shown] : {std::pair("rcan://a", 1U), std::pair("rcan://b", 0U)}) {
    FakeCall call(Of(Role::kViewer, "north"));
    const auto watch = Begin("/uplink.v1.FleetView/WatchRobots", call);
    ASSERT_NE(watch, nullptr);
    v1::WatchRobotsRequest request;
    request.add_ruris(ruri);
    request.add_ruris("rcan://never");
    watch->OnMessage(request.SerializeAsString());
    RunJobs(*watch);
    ASSERT_EQ(call.written.size(), shown + 1) << ruri;
    v1::RobotChange end;
    ASSERT_TRUE(end.ParseFromString(call.written.back()));
    EXPECT_EQ(end.snapshot_end().robots(), std::int64_t{shown});
  }
  FakeCall both(Of(Role::kViewer));
  const auto watch = Begin("/uplink.v1.FleetView/WatchRobots", both);
  v1::WatchRobotsRequest request;
  request.add_ruris("rcan://b");
  watch->OnMessage(request.SerializeAsString());
  RunJobs(*watch);
  ASSERT_EQ(both.written.size(), 2U) << "of two robots one is named";
  v1::RobotChange robot;
  ASSERT_TRUE(robot.ParseFromString(both.written.front()));
  EXPECT_EQ(robot.robot().ruri(), "rcan://b");
}

TEST_F(FleetMethodsTest, AWatchEndsOnceItsTokenIsRevoked) {
  const transport::CallerProof proof = OfToken();
  FakeCall call(proof);
  const auto watch = Begin("/uplink.v1.FleetView/WatchRobots", call);
  ASSERT_NE(watch, nullptr) << *call.end;
  EXPECT_FALSE(call.caller.empty()) << "its connection counts as its own";
  watch->OnMessage("");
  RunJobs(*watch);
  ASSERT_EQ(watch->deadline(), world_.clock.Steady() + http::kCallerJudgedEvery);
  world_.clock.Advance(http::kCallerJudgedEvery);
  watch->OnTimer();
  ASSERT_FALSE(call.end) << "its token counts";
  tokens_ = std::make_shared<const http::Tokens>();
  watch->OnTimer();
  EXPECT_FALSE(call.end) << "not before it is judged again";
  world_.clock.Advance(http::kCallerJudgedEvery);
  watch->OnTimer();
  EXPECT_EQ(call.end.value().code(), absl::StatusCode::kUnauthenticated);
}

TEST_F(FleetMethodsTest, AWatchThatEndsLeavesItsPlace) {
  FakeCall call(Of(Role::kViewer));
  auto watch = Begin("/uplink.v1.FleetView/WatchRobots", call);
  ASSERT_NE(watch, nullptr);
  watch->OnMessage("");
  RunJobs(*watch);
  EXPECT_EQ(world_.watches.size(), 1U);
  watch->OnBroken({});
  watch.reset();
  EXPECT_EQ(world_.watches.size(), 0U);
}

TEST_F(FleetMethodsTest, AWatchIsJudgedAsAListIs) {
  FakeCall call(Of(Role::kViewer));
  const auto watch = Begin("/uplink.v1.FleetView/WatchRobots", call);
  ASSERT_NE(watch, nullptr);
  v1::WatchRobotsRequest request;
  request.mutable_filter()->set_presence("here");
  watch->OnMessage(request.SerializeAsString());
  EXPECT_EQ(call.end->code(), absl::StatusCode::kInvalidArgument);
  FakeCall stranger({});
  EXPECT_EQ(Begin("/uplink.v1.FleetView/WatchRobots", stranger), nullptr);
}

TEST_F(FleetMethodsTest, HealthIsOpenAndFollowsReadiness) {
  using Check = ::grpc::health::v1::HealthCheckResponse;
  ::grpc::health::v1::HealthCheckRequest request;
  const auto check = [&] { return Call<Check>("/grpc.health.v1.Health/Check", {}, request); };
  ASSERT_TRUE(check().ok()) << check().status();
  FakeCall call({});
  const auto watch = Begin("/grpc.health.v1.Health/Watch", call);
  ASSERT_NE(watch, nullptr);
  watch->OnMessage("");
  ASSERT_EQ(call.written.size(), 1U);
  watch->OnWritten();
  world_.monitor.BeginDrain();
  EXPECT_EQ(check()->status(), Check::NOT_SERVING);
  world_.clock.Advance(kHealthLook);
  watch->OnTimer();
  Check told;
  ASSERT_TRUE(told.ParseFromString(call.written.back()));
  EXPECT_EQ(told.status(), Check::NOT_SERVING);
  request.set_service("nothing");
  EXPECT_EQ(check().status().code(), absl::StatusCode::kNotFound);
}

TEST_F(FleetMethodsTest, ChecksOfTheHealthTakeNoPlaceOfCalls) {
  const std::string check = "/grpc.health.v1.Health/Check";
  EXPECT_EQ(methods_.at(check).admission, transport::Admission::kHealth);
  EXPECT_EQ(methods_.at("/grpc.health.v1.Health/Watch").admission, transport::Admission::kHealth);
  std::deque<FakeCall> idle;
  std::vector<std::unique_ptr<transport::CallHandler>> open;
  for (std::size_t i = 0; i < 2 * kUnaryCallsMax; ++i) {
    open.push_back(Begin(check, idle.emplace_back(transport::CallerProof())));
    ASSERT_NE(open.back(), nullptr);
  }
  EXPECT_TRUE(
      View<v1::ListRobotsResponse>("ListRobots", Of(Role::kViewer), v1::ListRobotsRequest()).ok());
  world_.clock.Advance(kRequestWait);
  open.front()->OnTimer();
  EXPECT_EQ(idle.front().end->code(), absl::StatusCode::kDeadlineExceeded);
}

TEST_F(FleetMethodsTest, ReflectionTellsTheContract) {
  using Answer = ::grpc::reflection::v1::ServerReflectionResponse;
  for (const std::string_view package : kReflectionPackages) {
    FakeCall call(Of(Role::kViewer));
    const auto talk =
        Begin("/" + std::string(package) + ".ServerReflection/ServerReflectionInfo", call);
    ASSERT_NE(talk, nullptr);
    ::grpc::reflection::v1::ServerReflectionRequest request;
    request.set_file_containing_symbol("uplink.v1.FleetView.ListRobots");
    talk->OnMessage(request.SerializeAsString());
    Answer answer;
    ASSERT_TRUE(answer.ParseFromString(call.written.at(0)));
    google::protobuf::FileDescriptorProto file;
    ASSERT_TRUE(file.ParseFromString(answer.file_descriptor_response().file_descriptor_proto(0)));
    EXPECT_EQ(file.name(), "uplink/v1/fleet.proto");
    talk->OnWritten();
    request.set_list_services("");
    talk->OnMessage(request.SerializeAsString());
    ASSERT_TRUE(answer.ParseFromString(call.written.at(1)));
    EXPECT_THAT(answer.ShortDebugString(), HasSubstr("uplink.v1.FleetView"));
    talk->OnHalfClose();
    EXPECT_EQ(call.end, absl::OkStatus());
  }
  FakeCall stranger({});
  EXPECT_EQ(Begin("/grpc.reflection.v1.ServerReflection/ServerReflectionInfo", stranger), nullptr);
}

}  // namespace
}  // namespace uplink::rpc
