#include "server/http/guard.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/http/rights.h"
#include "server/identity/token_line.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::http {
namespace {

using identity::Role;
using identity::Scope;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr std::array<std::uint8_t, identity::kTokenRandomBytes> kRandom{7};
constexpr const char* kMetricsToken = "uplinkd_of_metrics";

RouteId IdOf(const std::string& path) { return FindRoute(path).id; }

class GuardTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const identity::NewToken made = identity::MakeToken(kRandom);
    token_ = made.token;
    entry_ = {.id = identity::TokenIdOf(made.hash),
              .role = Role::kViewer,
              .scope = Scope::Of({"north"}),
              .hash = made.hash};
    WriteTable();
  }

  void WriteTable() {
    auto table = identity::TokenTable::Parse(identity::LineOf(entry_), "tokens");
    ASSERT_TRUE(table.ok()) << table.status();
    tokens_ = std::make_shared<const Tokens>(
        Tokens{*std::move(table), identity::HashOfToken(kMetricsToken)});
  }

  Guard::Options Options(bool asks = true) {
    return {.asks = asks, .tokens = [this] { return tokens_; }};
  }
  Guard& guard() {
    if (!guard_) guard_ = std::make_unique<Guard>(context(), Options());
    return *guard_;
  }
  Guard::Context context() { return {clock_, logger_, probe_}; }

  Request ByToken(const std::string& token) {
    Request request;
    request.authorization = "Bearer " + token;
    return request;
  }
  static Request ByCertificate(absl::StatusOr<identity::PeerIdentity> identity) {
    Request request;
    request.certificate = std::make_shared<const PeerCertificate>(
        PeerCertificate{.identity = std::move(identity),
                        .subject = "CN=anna",
                        .expiry = FromUnixMs(4'000'000'000'000)});
    return request;
  }

  /// 200: it may ask.
  int StatusOf(const Request& request, const std::string& path) {
    const Guard::Answer answer = guard().Ask(request, IdOf(path));
    return answer.refusal ? answer.refusal->status : 200;
  }
  [[nodiscard]] std::int64_t Count(Denied why) const {
    return probe_.denied[static_cast<std::size_t>(why)].value();
  }

  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  HttpProbe probe_;
  std::string token_;
  identity::TokenEntry entry_;
  std::shared_ptr<const Tokens> tokens_;
  std::unique_ptr<Guard> guard_;
};

TEST_F(GuardTest, WithoutAuthenticationEveryCallerIsLocal) {
  guard_ = std::make_unique<Guard>(context(), Guard::Options{});
  const Guard::Answer answer = guard().Ask(ByToken("whatever"), IdOf("/api/v1/config"));
  EXPECT_FALSE(answer.refusal);
  EXPECT_EQ(answer.caller.role, Role::kAdmin);
  EXPECT_TRUE(answer.caller.scope.all());
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(GuardTest, TheFirstUseOfATokenTellsItsNote) {
  entry_.note = "ann";
  WriteTable();
  std::vector<std::string> notes;
  Guard::Options options = Options();
  options.first_use = [&notes](const identity::Caller& caller, const std::string& from) {
    notes.push_back(caller.note + " from " + from);
  };
  guard_ = std::make_unique<Guard>(context(), std::move(options));
  Request request = ByToken(token_);
  request.from = "192.0.2.1";
  EXPECT_EQ(StatusOf(request, "/api/v1/robots"), 200);
  EXPECT_EQ(StatusOf(request, "/api/v1/robots"), 200);
  EXPECT_THAT(notes, ::testing::ElementsAre("ann from 192.0.2.1"));
}

TEST_F(GuardTest, WithoutAProofProbesAloneAreAnswered) {
  for (const ListenerId listener : {ListenerId::kHttp, ListenerId::kMetrics}) {
    Request request;
    request.listener = listener;
    for (const Route& route : Routes()) {
      const std::string path(route.pattern);
      const int wanted = route.needs.right == Right::kAnyone ? 200 : 401;
      EXPECT_EQ(StatusOf(request, path), wanted) << path;
    }
    EXPECT_EQ(StatusOf(request, "/nowhere"), 401);
  }
  const auto answer = guard().Ask({}, IdOf("/api/v1/robots"));
  ASSERT_TRUE(answer.refusal);
  EXPECT_EQ(answer.refusal->authenticate, "Bearer");
  EXPECT_THAT(answer.refusal->body, HasSubstr(R"("code":"UNAUTHENTICATED")"));
  Request basic;
  basic.authorization = "Basic YTpi";
  EXPECT_EQ(StatusOf(basic, "/api/v1/robots"), 401);
  EXPECT_GT(Count(Denied::kNoProof), 20);
}

TEST_F(GuardTest, ATokenShowsRoleAndFleets) {
  const Guard::Answer answer = guard().Ask(ByToken(token_), IdOf("/api/v1/robots"));
  ASSERT_FALSE(answer.refusal);
  EXPECT_EQ(answer.caller.role, Role::kViewer);
  EXPECT_EQ(answer.caller.scope, Scope::Of({"north"}));
  EXPECT_EQ(answer.caller.proof, identity::Proof::kToken);
  EXPECT_EQ(answer.caller.name, entry_.id);
}

TEST_F(GuardTest, AWrongTokenIsInvalid) {
  for (const std::string& wrong :
       {std::string(), std::string("x"), token_ + "x", token_ + ", " + token_}) {
    const Guard::Answer answer = guard().Ask(ByToken(wrong), IdOf("/api/v1/robots"));
    ASSERT_TRUE(answer.refusal);
    EXPECT_EQ(answer.refusal->status, 401);
    EXPECT_EQ(answer.refusal->authenticate, R"(Bearer error="invalid_token")");
    EXPECT_THAT(answer.refusal->body, Not(HasSubstr(token_)));
  }
  EXPECT_EQ(Count(Denied::kBadToken), 4);
  EXPECT_THAT(lines_, Each(Not(HasSubstr(token_))));
}

TEST_F(GuardTest, AnExpiredTokenSaysSo) {
  entry_.expires = clock_.System() + std::chrono::seconds(60);
  WriteTable();
  EXPECT_EQ(StatusOf(ByToken(token_), "/api/v1/robots"), 200);
  clock_.Advance(std::chrono::seconds(61));
  const Guard::Answer answer = guard().Ask(ByToken(token_), IdOf("/api/v1/robots"));
  ASSERT_TRUE(answer.refusal);
  EXPECT_EQ(answer.refusal->authenticate, R"(Bearer error="invalid_token")");
  EXPECT_THAT(answer.refusal->body, HasSubstr("the token has expired"));
  EXPECT_EQ(Count(Denied::kExpiredToken), 1);
  EXPECT_THAT(lines_.back(), HasSubstr("name=" + entry_.id)) << "whose it is";
}

TEST_F(GuardTest, TheListenerWithoutTlsTakesScrapersAlone) {
  Request request = ByToken(token_);
  request.listener = ListenerId::kMetrics;
  const Guard::Answer answer = guard().Ask(request, IdOf("/metrics/robots"));
  ASSERT_TRUE(answer.refusal);
  EXPECT_EQ(answer.refusal->status, 403);
  EXPECT_THAT(answer.refusal->body, HasSubstr("has the role viewer"));
  entry_.role = Role::kMetrics;
  WriteTable();
  EXPECT_EQ(StatusOf(request, "/metrics/robots"), 200);
}

TEST_F(GuardTest, ACertificateShowsRoleAndFleet) {
  const Guard::Answer answer = guard().Ask(
      ByCertificate(identity::PeerIdentity{Role::kOperator, "north"}), IdOf("/api/v1/top"));
  ASSERT_FALSE(answer.refusal);
  EXPECT_EQ(answer.caller.role, Role::kOperator);
  EXPECT_EQ(answer.caller.scope, Scope::Of({"north"}));
  EXPECT_EQ(answer.caller.name, "CN=anna");
  EXPECT_TRUE(
      guard()
          .Ask(ByCertificate(identity::PeerIdentity{Role::kAdmin, "*"}), IdOf("/api/v1/top"))
          .caller.scope.all());
}

TEST_F(GuardTest, ATokenGoesBeforeACertificate) {
  Request both = ByCertificate(identity::PeerIdentity{Role::kAdmin, "*"});
  both.authorization = "Bearer " + token_;
  EXPECT_EQ(guard().Ask(both, IdOf("/api/v1/top")).caller.role, Role::kViewer);
  both.authorization = "Bearer wrong";
  EXPECT_EQ(StatusOf(both, "/api/v1/top"), 401);
}

TEST_F(GuardTest, ACertificateOfRobotsOrGatewaysOpensNothing) {
  for (const Role role : {Role::kRobot, Role::kGateway}) {
    const Request request = ByCertificate(identity::PeerIdentity{role, "north", "rcan://a"});
    for (const char* path : {"/api/v1/robots", "/metrics", "/nowhere"}) {
      const Guard::Answer answer = guard().Ask(request, IdOf(path));
      ASSERT_TRUE(answer.refusal) << path;
      EXPECT_EQ(answer.refusal->status, 403) << path;
    }
    EXPECT_THAT(guard().Ask(request, IdOf("/api/v1/robots")).refusal->body,
                AllOf(HasSubstr("needs the role viewer, operator or admin"),
                      HasSubstr(std::string("has the role ") + std::string(ToText(role)))));
    EXPECT_EQ(StatusOf(request, "/livez"), 200);
  }
}

TEST_F(GuardTest, ABadOrExpiredCertificateSaysWhy) {
  const Request bad = ByCertificate(absl::UnauthenticatedError("client certificate: it is old"));
  const Guard::Answer answer = guard().Ask(bad, IdOf("/api/v1/robots"));
  ASSERT_TRUE(answer.refusal);
  EXPECT_EQ(answer.refusal->status, 401);
  EXPECT_THAT(answer.refusal->body, HasSubstr("client certificate: it is old"));
  const Request good = ByCertificate(identity::PeerIdentity{Role::kAdmin, "*"});
  EXPECT_EQ(StatusOf(good, "/api/v1/robots"), 200);
  clock_.SetSystem(good.certificate->expiry);
  EXPECT_EQ(StatusOf(good, "/api/v1/robots"), 401) << "its connection has outlived it";
  EXPECT_EQ(Count(Denied::kBadCertificate), 2);
}

TEST_F(GuardTest, ARevokedCertificateOpensNothingFromTheNextRequestOn) {
  identity::DenyList denied;
  Guard::Options options = Options();
  options.denied = &denied;
  guard_ = std::make_unique<Guard>(context(), options);
  identity::NamedCertificate own{.shown = {.serial = "0A"}, .issuer = "CN=operators"};
  PeerCertificate shown =
      *ByCertificate(identity::PeerIdentity{.role = Role::kViewer, .fleet = "north"}).certificate;
  shown.chain = {own};
  Request request;
  request.certificate = std::make_shared<const PeerCertificate>(shown);
  EXPECT_EQ(StatusOf(request, "/api/v1/robots"), 200);
  const auto deny = [&denied](const char* value) {
    auto list = std::make_shared<identity::DeniedCertificates>();
    EXPECT_TRUE(list->Add(storage::RevokedBy::kIssuerSerial, value));
    denied.Set(list);
  };
  deny("0A CN=others");
  EXPECT_EQ(StatusOf(request, "/api/v1/robots"), 200);
  deny("0A CN=operators");
  EXPECT_EQ(StatusOf(request, "/api/v1/robots"), 401);
  EXPECT_EQ(Count(Denied::kBadCertificate), 1);
}

TEST_F(GuardTest, TheTokenOfMetricsOpensScrapesOnTheirListenerAlone) {
  for (const bool asks : {false, true}) {
    guard_ = std::make_unique<Guard>(context(), Options(asks));
    Request request = ByToken(kMetricsToken);
    request.listener = ListenerId::kMetrics;
    EXPECT_EQ(StatusOf(request, "/metrics"), 200);
    EXPECT_EQ(StatusOf(request, "/metrics/robots"), 200);
    request.authorization = "Bearer other";
    EXPECT_EQ(StatusOf(request, "/metrics"), 401);
    request.authorization.reset();
    EXPECT_EQ(StatusOf(request, "/metrics"), 401);
    EXPECT_EQ(StatusOf(request, "/readyz"), 200);
  }
  EXPECT_EQ(StatusOf(ByToken(kMetricsToken), "/metrics"), 401) << "of another listener";
  guard_ = std::make_unique<Guard>(context(), Options(false));
  EXPECT_EQ(StatusOf({}, "/metrics"), 200) << "listen.http asks for nothing";
}

TEST_F(GuardTest, TooManyWrongProofsOfASourceGet429AndGoodOnesPass) {
  Request wrong = ByToken("wrong");
  wrong.source = {1};
  constexpr auto kMost = limits::PolicyOf(limits::PolicyId::kFailedProofsOfSource).most;
  for (std::uint64_t i = 0; i < kMost; ++i) {
    ASSERT_EQ(StatusOf(wrong, "/api/v1/robots"), 401) << i;
  }
  const Guard::Answer answer = guard().Ask(wrong, IdOf("/api/v1/robots"));
  ASSERT_TRUE(answer.refusal);
  EXPECT_EQ(answer.refusal->status, 429);
  EXPECT_EQ(answer.refusal->retry_after, std::chrono::seconds(60));
  Request good = ByToken(token_);
  Request none;
  good.source = none.source = wrong.source;
  EXPECT_EQ(StatusOf(good, "/api/v1/robots"), 200);
  EXPECT_EQ(StatusOf(none, "/api/v1/robots"), 429);
  EXPECT_EQ(StatusOf(none, "/livez"), 200);
  wrong.source = {2};
  EXPECT_EQ(StatusOf(wrong, "/api/v1/robots"), 401) << "of another source";
  clock_.Advance(std::chrono::seconds(60));
  EXPECT_EQ(StatusOf(none, "/api/v1/robots"), 401);
  EXPECT_EQ(Count(Denied::kTooMany), 2);
}

TEST_F(GuardTest, WhoShowsNothingIsNotCountedAsWrong) {
  for (int i = 0; i < 50; ++i) ASSERT_EQ(StatusOf({}, "/api/v1/robots"), 401);
  EXPECT_EQ(Count(Denied::kTooMany), 0);
}

TEST_F(GuardTest, LogsTheFirstUseOfEachProof) {
  Request request = ByToken(token_);
  request.from = "192.0.2.7";
  for (int i = 0; i < 3; ++i) EXPECT_EQ(StatusOf(request, "/api/v1/robots"), 200);
  EXPECT_EQ(StatusOf(ByCertificate(identity::PeerIdentity{Role::kAdmin, "*"}), "/api/v1/top"), 200);
  EXPECT_THAT(lines_,
              ElementsAre(AllOf(HasSubstr(" info http_caller name=" + entry_.id + " role=viewer"),
                                HasSubstr("proof=token from=192.0.2.7")),
                          HasSubstr("name=\"CN=anna\" role=admin proof=certificate")));
}

TEST_F(GuardTest, LogsWhatItDeniesWithBoundsPerSource) {
  Request request = ByToken("wrong");
  request.from = "192.0.2.7";
  for (int i = 0; i < 5; ++i) EXPECT_EQ(StatusOf(request, "/api/v1/robots"), 401);
  EXPECT_THAT(lines_, SizeIs(DeniedLines::kLinesPerSource));
  EXPECT_THAT(lines_[0], HasSubstr("http_denied why=bad_token route=robots"));
  EXPECT_THAT(lines_[0], HasSubstr("from=192.0.2.7"));
  request.source = {1};
  EXPECT_EQ(StatusOf(request, "/api/v1/robots"), 401);
  EXPECT_THAT(lines_, SizeIs(DeniedLines::kLinesPerSource + 1)) << "another source is heard";
  const Request other = ByCertificate(identity::PeerIdentity{Role::kRobot, "north"});
  EXPECT_EQ(StatusOf(other, "/api/v1/robots"), 403);
  EXPECT_THAT(lines_.back(), HasSubstr("http_denied why=role")) << "another cause is heard";
  clock_.Advance(DeniedLines::kSpan);
  request.source = {};
  EXPECT_EQ(StatusOf(request, "/api/v1/robots"), 401);
  EXPECT_THAT(lines_.back(), HasSubstr("suppressed=3"));
}

// What each role sees, of one fleet and of all.
TEST_F(GuardTest, EachRoleSeesWhatTheTableOfRightsSays) {
  for (const Role role : {Role::kMetrics, Role::kViewer, Role::kOperator, Role::kAdmin}) {
    for (const char* fleet : {"north", "*"}) {
      for (const Route& route : Routes()) {
        const bool whole = std::string_view(fleet) == "*";
        const bool may = Has(role, route.needs.right) &&
                         (whole || !route.needs.whole || route.needs.right == Right::kAnyone);
        EXPECT_EQ(StatusOf(ByCertificate(identity::PeerIdentity{role, fleet}),
                           std::string(route.pattern)),
                  may ? 200 : 403)
            << ToText(role) << ' ' << fleet << ' ' << route.pattern;
      }
    }
  }
  const auto body = [this](Role role, const char* fleet, const char* path) {
    return guard()
        .Ask(ByCertificate(identity::PeerIdentity{role, fleet}), IdOf(path))
        .refusal->body;
  };
  EXPECT_THAT(body(Role::kViewer, "*", "/api/v1/config"),
              HasSubstr("this needs the role operator or admin; CN=anna has the role viewer"));
  EXPECT_THAT(
      body(Role::kMetrics, "*", "/api/v1/robots"),
      HasSubstr("this needs the role viewer, operator or admin; CN=anna has the role metrics"));
  EXPECT_THAT(body(Role::kAdmin, "north", "/api/v1/status"),
              HasSubstr("needs the scope *; CN=anna has the role admin for north alone"));
  EXPECT_GT(Count(Denied::kRole), 0);
  EXPECT_GT(Count(Denied::kScope), 0);
}

}  // namespace
}  // namespace uplink::http
