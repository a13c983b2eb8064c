#include "server/admin/commands.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/admin/actions.h"
#include "server/admin/command_rate.h"
#include "server/limits/policies.h"
#include "tests/support/fake_access_store.h"
#include "tests/support/fake_database.h"
#include "tests/support/fake_reader.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::admin {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr const char* kNorth = "rcan://example.com/north/1";
constexpr const char* kSouth = "rcan://example.com/south/1";
constexpr const char* kUnknown = "rcan://example.com/none/1";

template <typename Answer>
std::string TextOf(const absl::StatusOr<Answer>& answer) {
  return std::string(answer.status().message());
}

class CommandsTest : public ::testing::Test {
 protected:
  static std::optional<std::string> FleetOf(std::string_view ruri) {
    if (ruri == kNorth) return "north";
    if (ruri == kSouth) return "south";
    return std::nullopt;
  }
  static Asker OfNorth() {
    return AskerOf({.role = identity::Role::kOperator,
                    .scope = identity::Scope::Of({"north"}),
                    .proof = identity::Proof::kToken,
                    .name = "1f2e3d4c"},
                   "192.0.2.1");
  }
  absl::StatusOr<v1::RobotSetting> Block(const Asker& asker, const std::string& ruri) {
    v1::BlockRobotRequest request;
    request.set_ruri(ruri);
    request.set_reason("stolen");
    return commands_.BlockRobot(asker, request);
  }
  storage::AuditRow LastRow() {
    trail_.Flush(shared_);
    const auto page = testing::FakeReader(database_).Audit({});
    EXPECT_TRUE(page.ok()) << page.status();
    return page.ok() && !page->rows.empty() ? page->rows.front() : storage::AuditRow();
  }

  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  testing::FakeDatabase database_;
  testing::FakeAccessStore store_{database_};
  SharedStore shared_{store_};
  AuditTrail trail_{logger_};
  int changes_ = 0;
  storage::AuditQuery asked_;
  std::string only_calls_;
  const Asker local_ = AskerOf(identity::LocalCaller(), "");
  Commands commands_{{.clock = clock_,
                      .store = shared_,
                      .audit = trail_,
                      .rows_of_audit =
                          [this](const storage::AuditQuery& query) {
                            asked_ = query;
                            return testing::FakeReader(database_).Audit(query);
                          },
                      .fleet_of = FleetOf,
                      .only_calls = [this](std::string_view ruri) { return ruri == only_calls_; },
                      .changed = [this] { ++changes_; },
                      .reload = {}}};
};

TEST_F(CommandsTest, BlocksARobotOfItsScopeAndTellsIt) {
  const absl::StatusOr<v1::RobotSetting> setting = Block(OfNorth(), kNorth);
  ASSERT_TRUE(setting.ok()) << setting.status();
  EXPECT_TRUE(setting->blocked());
  EXPECT_EQ(setting->blocked_by(), "1f2e3d4c");
  EXPECT_EQ(changes_, 1);
  const storage::AuditRow row = LastRow();
  EXPECT_EQ(row.action, kRobotBlock);
  EXPECT_EQ(row.proof, storage::AuditProof::kToken);
  EXPECT_EQ(row.from, "192.0.2.1");
  EXPECT_EQ(row.fleet, "north");
  EXPECT_EQ(row.outcome, "ok");
  EXPECT_EQ(row.detail, "stolen");
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("info audit who=1f2e3d4c")));
}

TEST_F(CommandsTest, DisconnectsNoTwinAndNoDroneAndNamesTheWay) {
  const auto disconnect = [this](const std::string& ruri, const Asker& asker) {
    v1::DisconnectRobotRequest request;
    request.set_ruri(ruri);
    return commands_.DisconnectRobot(asker, request);
  };
  EXPECT_TRUE(disconnect(kNorth, local_).ok());
  only_calls_ = kNorth;
  for (const std::string& ruri :
       {std::string(kNorth), std::string("rcan://local.rcan/cyberwave/twin/"
                                         "11111111-2222-4333-8444-555555555555")}) {
    const absl::StatusOr<v1::RobotSetting> refused = disconnect(ruri, local_);
    EXPECT_EQ(refused.status().code(), absl::StatusCode::kFailedPrecondition) << ruri;
    EXPECT_THAT(TextOf(refused), HasSubstr("block it"));
    EXPECT_EQ(LastRow().outcome, "FAILED_PRECONDITION");
  }
  only_calls_ = kSouth;
  EXPECT_EQ(disconnect(kSouth, OfNorth()).status().code(), absl::StatusCode::kNotFound)
      << "out of scope";
}

TEST_F(CommandsTest, AnswersARobotOutOfScopeAsAnUnknownOne) {
  const absl::Status south = Block(OfNorth(), kSouth).status();
  const absl::Status unknown = Block(OfNorth(), kUnknown).status();
  EXPECT_EQ(south.code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(unknown.code(), absl::StatusCode::kNotFound);
  std::string text(south.message());
  text.replace(text.find(kSouth), std::string(kSouth).size(), kUnknown);
  EXPECT_EQ(text, std::string(unknown.message()));
  EXPECT_EQ(changes_, 0);
  const storage::AuditRow row = LastRow();
  EXPECT_EQ(row.outcome, "NOT_FOUND");
  EXPECT_EQ(row.target, kUnknown);
}

TEST_F(CommandsTest, BlocksAnUnknownRobotForACallerOfAllFleets) {
  EXPECT_TRUE(Block(local_, kUnknown).ok());
  EXPECT_EQ(LastRow().fleet, "");
}

TEST_F(CommandsTest, RefusesWhatNamesNoRobot) {
  EXPECT_THAT(TextOf(Block(local_, "")), StartsWith("ruri is missing"));
  EXPECT_THAT(TextOf(Block(local_, "http://x")), StartsWith("ruri "));
  EXPECT_EQ(LastRow().outcome, "INVALID_ARGUMENT");
}

TEST_F(CommandsTest, NotesAFailureOfTheStoreOnceItIsBack) {
  store_.status = absl::UnavailableError("away");
  EXPECT_EQ(Block(local_, kNorth).status().code(), absl::StatusCode::kUnavailable);
  store_.status = absl::OkStatus();
  EXPECT_EQ(LastRow().outcome, "UNAVAILABLE");
}

TEST_F(CommandsTest, SetsAndRemovesLabels) {
  v1::NoteRobotRequest request;
  request.set_ruri(kNorth);
  (*request.mutable_labels())["site"] = "hall 2";
  (*request.mutable_labels())["line"] = "";
  request.set_note("new wheels");
  const auto setting = commands_.NoteRobot(local_, request);
  ASSERT_TRUE(setting.ok()) << setting.status();
  EXPECT_EQ(setting->labels().at("site"), "hall 2");
  EXPECT_EQ(setting->note(), "new wheels");
  EXPECT_EQ(LastRow().detail, "line removed, site=hall 2, note: new wheels");
}

TEST_F(CommandsTest, RefusesLabelsThatAFilterCouldNotName) {
  for (const std::string name : {"", "a=b", "a b", "ä"}) {
    v1::NoteRobotRequest request;
    request.set_ruri(kNorth);
    (*request.mutable_labels())[name] = "x";
    EXPECT_THAT(TextOf(commands_.NoteRobot(local_, request)), StartsWith("labels ")) << name;
  }
  v1::NoteRobotRequest nothing;
  nothing.set_ruri(kNorth);
  EXPECT_THAT(TextOf(commands_.NoteRobot(local_, nothing)), StartsWith("labels or note"));
  v1::NoteRobotRequest line;
  line.set_ruri(kNorth);
  (*line.mutable_labels())["a"] = "b\nc";
  EXPECT_THAT(TextOf(commands_.NoteRobot(local_, line)), StartsWith("labels "));
}

TEST_F(CommandsTest, AddsAndRemovesARobotThatIsUnknown) {
  v1::AddRobotRequest request;
  request.set_ruri(kUnknown);
  EXPECT_TRUE(commands_.AddRobot(local_, request)->registered());
  EXPECT_EQ(LastRow().action, kRobotAdd);
  request.set_remove(true);
  EXPECT_FALSE(commands_.AddRobot(local_, request)->registered());
  EXPECT_EQ(LastRow().action, kRobotRemove);
}

TEST_F(CommandsTest, AcknowledgesNoFaultThatIsNotActive) {
  v1::AcknowledgeFaultRequest request;
  request.set_ruri(kNorth);
  request.set_fault_id("E8");
  request.set_note("seen");
  EXPECT_EQ(commands_.AcknowledgeFault(OfNorth(), request).status().code(),
            absl::StatusCode::kNotFound);
  EXPECT_EQ(LastRow().detail, "E8: seen");
  EXPECT_EQ(LastRow().outcome, "NOT_FOUND");
  request.clear_fault_id();
  EXPECT_THAT(TextOf(commands_.AcknowledgeFault(OfNorth(), request)),
              StartsWith("faultId is missing"));
}

TEST_F(CommandsTest, RevokesByEachOfThreeNames) {
  v1::RevokeCertificateRequest key;
  key.set_key_sha256(std::string(64, 'A'));
  key.set_reason("stolen");
  const auto revoked = commands_.RevokeCertificate(local_, key);
  ASSERT_TRUE(revoked.ok()) << revoked.status();
  EXPECT_EQ(revoked->key_sha256(), std::string(64, 'a'));
  EXPECT_EQ(LastRow().target, std::string(64, 'a'));

  v1::RevokeCertificateRequest serial;
  serial.set_serial("00:0a:bc");
  serial.set_issuer("CN=Robots,O=Example");
  const auto by_serial = commands_.RevokeCertificate(local_, serial);
  ASSERT_TRUE(by_serial.ok()) << by_serial.status();
  EXPECT_EQ(by_serial->serial(), "0ABC");
  EXPECT_EQ(by_serial->issuer(), "CN=Robots,O=Example");

  v1::UnrevokeCertificateRequest back;
  back.set_key_sha256(std::string(64, 'a'));
  EXPECT_TRUE(commands_.UnrevokeCertificate(local_, back).ok());
  const auto list = commands_.ListRevocations({});
  ASSERT_TRUE(list.ok()) << list.status();
  ASSERT_EQ(list->revocations_size(), 1);
  EXPECT_EQ(list->revocations(0).serial(), "0ABC");
}

TEST_F(CommandsTest, WritesNothingOfWhatIsSoAlready) {
  ASSERT_TRUE(Block(OfNorth(), kNorth).ok());
  v1::RevokeCertificateRequest key;
  key.set_key_sha256(std::string(64, 'a'));
  ASSERT_TRUE(commands_.RevokeCertificate(local_, key).ok());
  const std::size_t lines = lines_.size();
  const storage::AccessVersion before = *store_.Version();
  const auto again = Block(OfNorth(), kNorth);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_TRUE(again->blocked());
  EXPECT_EQ(again->blocked_by(), "1f2e3d4c");
  EXPECT_EQ(commands_.RevokeCertificate(local_, key)->key_sha256(), key.key_sha256());
  v1::NoteRobotRequest note;
  note.set_ruri(kNorth);
  note.set_note("");
  EXPECT_TRUE(commands_.NoteRobot(local_, note).ok());
  EXPECT_EQ(*store_.Version(), before);
  EXPECT_EQ(changes_, 2);
  EXPECT_EQ(lines_.size(), lines);
  EXPECT_EQ(LastRow().action, kCertificateRevoke);
}

TEST_F(CommandsTest, ACallerWhoFloodsIsRefusedAndNoOther) {
  constexpr const auto& kShare = limits::PolicyOf(limits::PolicyId::kCommandsOfCaller);
  for (std::uint64_t i = 0; i < kShare.at_once; ++i) {
    ASSERT_TRUE(Block(OfNorth(), kNorth).ok()) << i;
  }
  const absl::Status over = Block(OfNorth(), kNorth).status();
  EXPECT_EQ(over.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(std::string(over.message()),
            "a caller may give 5 commands about robots per second, 20 at once");
  EXPECT_EQ(RetryAfterOf(over), std::chrono::seconds(1));
  EXPECT_EQ(LastRow().outcome, "RESOURCE_EXHAUSTED");
  EXPECT_TRUE(Block(local_, kNorth).ok()) << "another caller";
  v1::RevokeCertificateRequest key;
  key.set_key_sha256(std::string(64, 'a'));
  EXPECT_TRUE(commands_.RevokeCertificate(OfNorth(), key).ok()) << "a share of its own";
  clock_.Advance(std::chrono::seconds(1));
  for (std::uint64_t i = 0; i < kShare.most; ++i) EXPECT_TRUE(Block(OfNorth(), kNorth).ok());
  EXPECT_FALSE(Block(OfNorth(), kNorth).ok());
}

TEST_F(CommandsTest, RefusesARevocationThatNamesNoneOrTwo) {
  v1::RevokeCertificateRequest request;
  EXPECT_EQ(commands_.RevokeCertificate(local_, request).status().code(),
            absl::StatusCode::kInvalidArgument);
  request.set_sha256(std::string(64, 'a'));
  request.set_key_sha256(std::string(64, 'b'));
  EXPECT_THAT(TextOf(commands_.RevokeCertificate(local_, request)),
              StartsWith("sha256 or keySha256"));
  request.clear_key_sha256();
  request.set_sha256("abc");
  EXPECT_THAT(TextOf(commands_.RevokeCertificate(local_, request)), StartsWith("sha256 must be"));
}

TEST_F(CommandsTest, ListsRevocationsPageByPage) {
  for (const char digit : {'1', '2', '3'}) {
    v1::RevokeCertificateRequest request;
    request.set_sha256(std::string(64, digit));
    ASSERT_TRUE(commands_.RevokeCertificate(local_, request).ok());
  }
  v1::ListRevocationsRequest request;
  request.set_page_size(2);
  const auto first = commands_.ListRevocations(request);
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(first->revocations_size(), 2);
  request.set_page_token(first->next_page_token());
  const auto second = commands_.ListRevocations(request);
  ASSERT_TRUE(second.ok());
  EXPECT_EQ(second->revocations_size(), 1);
  EXPECT_THAT(second->next_page_token(), IsEmpty());
  request.set_page_token("x");
  EXPECT_THAT(TextOf(commands_.ListRevocations(request)), StartsWith("pageToken"));
  request.set_page_size(-1);
  EXPECT_THAT(TextOf(commands_.ListRevocations(request)), StartsWith("pageSize"));
}

TEST_F(CommandsTest, AnIssuerIsTakenAsOpensslPrintsIt) {
  v1::RevokeCertificateRequest request;
  request.set_serial("serial=0ABC");
  for (const char* const issuer :
       {"issuer=CN=Robots,O=Example", "issuer= CN=Robots,O=Example", "CN=Robots,O=Example"}) {
    request.set_issuer(issuer);
    const auto revoked = commands_.RevokeCertificate(local_, request);
    ASSERT_TRUE(revoked.ok()) << revoked.status();
    EXPECT_EQ(revoked->issuer(), "CN=Robots,O=Example");
    EXPECT_EQ(revoked->serial(), "0ABC");
  }
  request.set_issuer("CN=a\\, b\\+c,1.2.3=#0401+O=d=e");
  EXPECT_TRUE(commands_.RevokeCertificate(local_, request).ok());
  for (const char* const issuer : {"Robots", "CN = Robots, O = Example", "/CN=Robots/O=Example",
                                   "CN=Robots, O=Example", "CN=Robots,", "=Robots"}) {
    request.set_issuer(issuer);
    EXPECT_THAT(TextOf(commands_.RevokeCertificate(local_, request)), StartsWith("issuer must be"))
        << issuer;
  }
  request.set_issuer("issuer=");
  EXPECT_THAT(TextOf(commands_.RevokeCertificate(local_, request)),
              StartsWith("issuer is missing"));
}

TEST_F(CommandsTest, ListsTheAudit) {
  ASSERT_TRUE(Block(OfNorth(), kNorth).ok());
  v1::ListAuditRequest request;
  request.set_who("1f2e3d4c");
  request.set_order_by("oldest");
  const auto list = commands_.ListAudit(request);
  ASSERT_TRUE(list.ok()) << list.status();
  ASSERT_EQ(list->audit_size(), 1);
  EXPECT_EQ(list->audit(0).proof(), "token");
  EXPECT_EQ(asked_.who, "1f2e3d4c");
  EXPECT_EQ(asked_.rows.order, storage::ListOrder::kOldestFirst);
}

TEST_F(CommandsTest, SaysThatNothingReloads) {
  EXPECT_EQ(commands_.Reload(local_, {}).status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(LastRow().action, kReload);
}

TEST(Reloaded, TheDetailNamesEachProblem) {
  EXPECT_EQ(DetailOf(Reloaded{.taken_over = {}, .needs_restart = {}, .problems = {"a: 1", "b: 2"}}),
            "a: 1; b: 2");
}

TEST_F(CommandsTest, NotesWhatARoleForbids) {
  commands_.NoteForbidden(OfNorth(), kCertificateRevoke, "");
  EXPECT_EQ(LastRow().outcome, "PERMISSION_DENIED");
}

}  // namespace
}  // namespace uplink::admin
