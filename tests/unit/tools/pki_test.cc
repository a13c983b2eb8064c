#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/model/ids.h"
#include "server/identity/certificate_gate.h"
#include "server/identity/peer_identity.h"
#include "server/identity/pem.h"
#include "server/identity/shown_certificate.h"
#include "tests/support/der.h"
#include "tests/support/odd_certificates.h"
#include "tests/support/pem_texts.h"
#include "tools/pki/directory.h"
#include "tools/pki/profile.h"
#include "tools/pki/shown.h"

namespace uplink::pki {
namespace {

namespace odd = testing::odd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "uplink-pki-XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string operator/(const std::string& name) const {
    return (path_ / name).string();
  }

 private:
  std::filesystem::path path_;
};

mode_t ModeOf(const std::string& path) {
  struct stat info {};
  EXPECT_EQ(stat(path.c_str(), &info), 0) << path;
  return info.st_mode & 07777U;
}

std::string Message(const absl::Status& status) { return std::string(status.message()); }

TEST(Authority, HasANameOfItsOwnUnlessOneIsGiven) {
  const auto name_of = [](const std::string& given) {
    const auto authority = Authority::Create(given, 1);
    EXPECT_TRUE(authority.ok()) << authority.status();
    const auto read =
        identity::ReadCertificates({"ca.crt", (*authority)->credentials().certificate_pem});
    EXPECT_TRUE(read.ok()) << read.status();
    return identity::IssuerOf(*read->front());
  };
  EXPECT_EQ(name_of("hall"), "CN=hall");
  const std::string first = name_of("");
  EXPECT_EQ(first.rfind("CN=uplinkd development authority ", 0), 0U) << first;
  EXPECT_NE(first, name_of(""));
}

TEST(Profiles, TheServerReadsTheIdentityThatWasAskedFor) {
  const auto authority = Authority::Create("test", 10);
  ASSERT_TRUE(authority.ok());
  const auto identity_of =
      [&](const absl::StatusOr<Profile>& profile) -> absl::StatusOr<identity::PeerIdentity> {
    EXPECT_TRUE(profile.ok()) << profile.status();
    const auto made = (*authority)->Issue(*profile, 10);
    EXPECT_TRUE(made.ok()) << made.status();
    const auto certificates = identity::ReadCertificates({"made", made->certificate_pem});
    if (!certificates.ok()) return certificates.status();
    return identity::IdentityOf(*certificates->front());
  };
  const auto robot = identity_of(RobotProfile("rcan://a/b/c/d/1", "north", "r1"));
  ASSERT_TRUE(robot.ok()) << robot.status();
  EXPECT_EQ(robot->role, identity::Role::kRobot);
  EXPECT_EQ(robot->fleet, "north");
  EXPECT_EQ(robot->ruri, "rcan://a/b/c/d/1");
  const auto gateway = identity_of(GatewayProfile({"rcan://a/1", "rcan://a/2"}, "north", "g"));
  ASSERT_TRUE(gateway.ok()) << gateway.status();
  EXPECT_EQ(gateway->role, identity::Role::kGateway);
  EXPECT_THAT(gateway->gateway.ruris, ElementsAre("rcan://a/1", "rcan://a/2"));
  const auto admin = identity_of(OperatorProfile("admin", "*", "ann"));
  ASSERT_TRUE(admin.ok()) << admin.status();
  EXPECT_EQ(admin->role, identity::Role::kAdmin);
  EXPECT_EQ(admin->fleet, "*");
  const auto scraper = identity_of(OperatorProfile("metrics", "north", "prometheus"));
  ASSERT_TRUE(scraper.ok()) << scraper.status();
  EXPECT_EQ(scraper->role, identity::Role::kMetrics);
  // A server's certificate is no robot's or operator's identity.
  EXPECT_FALSE(identity_of(ServerProfile({"localhost", "::1"})).ok());
}

TEST(Profiles, RuriAtItsLimit) {
  const std::string longest = "rcan://" + std::string(249, 'x');
  EXPECT_TRUE(RobotProfile(longest, "f", "n").ok());
  EXPECT_FALSE(RobotProfile(longest + "x", "f", "n").ok());
}

TEST(Profiles, TwinsHaveNoCertificates) {
  const std::string twin = "rcan://local.rcan/cyberwave/twin/T";
  EXPECT_FALSE(RobotProfile(twin, "f", "n").ok());
  EXPECT_FALSE(GatewayProfile({"rcan://a/1", twin}, "f", "g").ok());
  EXPECT_TRUE(RobotProfile("rcan://local.rcan/cyberwave/arm/T", "f", "n").ok());
}

TEST(Profiles, RuriThatIsNone) {
  for (const char* const ruri : {"", "rcan://", "http://a/b", "rcan://a,URI:rcan://b", "rcan://a b",
                                 "rcan://\xC3\xA9", "RCAN://a"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(RobotProfile(ruri, "f", "n").status())) << ruri;
  }
}

TEST(Profiles, NamesAtTheirLimit) {
  const std::string longest(64, 'f');
  EXPECT_TRUE(RobotProfile("rcan://a", longest, "n").ok());
  EXPECT_FALSE(RobotProfile("rcan://a", longest + "f", "n").ok());
  EXPECT_FALSE(RobotProfile("rcan://a", "", "n").ok());
  EXPECT_FALSE(OperatorProfile("owner", "f", "n").ok());
}

TEST(Profiles, AFleetThatTheRelayRefusesIsNamed) {
  // U+200B, C1's U+0085, and U+0378, which is not assigned.
  for (const char* const fleet : {"no\xE2\x80\x8Brth", "no\xC2\x85rth", "no\xCD\xB8rth"}) {
    for (const absl::Status& status :
         {RobotProfile("rcan://a", fleet, "n").status(), GatewayProfile({}, fleet, "n").status(),
          OperatorProfile("viewer", fleet, "n").status()}) {
      EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
      EXPECT_THAT(Message(status), HasSubstr("fleet \"no"));
    }
  }
  EXPECT_THAT(Message(RobotProfile("rcan://a", "no\xE2\x80\x8Brth", "n").status()),
              HasSubstr("it holds U+200B, which is invisible"));
  EXPECT_TRUE(RobotProfile("rcan://a", "Köln", "n").ok());
  EXPECT_THAT(Message(RobotProfile("rcan://a", "*", "n").status()), HasSubstr("fleet \"*\""));
  EXPECT_THAT(Message(GatewayProfile({}, "*", "n").status()), HasSubstr("fleet \"*\""));
  EXPECT_TRUE(OperatorProfile("viewer", "*", "n").ok());
}

TEST(Profiles, HostsOfAServer) {
  const auto profile = ServerProfile({"localhost", "127.0.0.1", "::1"});
  ASSERT_TRUE(profile.ok());
  EXPECT_THAT(profile->alternative_names, ElementsAre("DNS:localhost", "IP:127.0.0.1", "IP:::1"));
  EXPECT_FALSE(ServerProfile({}).ok());
  EXPECT_THAT(Message(ServerProfile({"a,DNS:b"}).status()), HasSubstr("\"a,DNS:b\""));
}

TEST(Authority, RefusesAValidityOutOfRange) {
  EXPECT_TRUE(Authority::Create("test", 1).ok());
  EXPECT_TRUE(Authority::Create("test", kDaysMax).ok());
  EXPECT_FALSE(Authority::Create("test", 0).ok());
  EXPECT_FALSE(Authority::Create("test", kDaysMax + 1).ok());
}

std::vector<std::string> RurisOf(std::size_t count, std::size_t bytes) {
  std::vector<std::string> ruris;
  for (std::size_t i = 0; i < count; ++i) {
    std::string ruri = "rcan://fleet.example/" + std::to_string(1000 + i);
    ruri.resize(bytes, 'x');
    ruris.push_back(std::move(ruri));
  }
  return ruris;
}

TEST(Authority, IssuesNoCertificateThatTheRelayDoesNotLookInto) {
  const auto authority = Authority::Create("test", 10);
  ASSERT_TRUE(authority.ok());
  const auto issue = [&](std::size_t robots, std::size_t bytes) {
    const auto profile = GatewayProfile(RurisOf(robots, bytes), "north", "g");
    EXPECT_TRUE(profile.ok()) << profile.status();
    return (*authority)->Issue(*profile, 10).status();
  };
  EXPECT_TRUE(issue(kGatewayRobotsMax, 100).ok());
  EXPECT_TRUE(issue(100, model::kRuriBytesMax).ok());
  const absl::Status refused = issue(kGatewayRobotsMax, model::kRuriBytesMax);
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(Message(refused), HasSubstr("the relay takes at most 32768"));
}

TEST(Shown, AMessageAtItsLimitIsTakenAndOneByteMoreIsNot) {
  const auto certificate_of = [](std::size_t bytes) {
    odd::Parts parts;
    parts.key = odd::Ed25519Key();
    parts.extensions = odd::Extension("\x2A", testing::der::Octets(std::string(bytes, 'x')));
    return odd::CertificateOf(parts);
  };
  constexpr std::size_t kContent = 30'000;
  const std::size_t frame = odd::MessageOf13({certificate_of(kContent)}).size() - kContent;
  const std::size_t most = identity::kShownBytesMax - frame;
  EXPECT_EQ(CheckShown({certificate_of(most)}), absl::OkStatus());
  EXPECT_THAT(Message(CheckShown({certificate_of(most + 1)})),
              HasSubstr("would have 32769 bytes, and the relay takes at most 32768"));
}

TEST(Shown, AKeyThatTheRelayDoesNotTakeIsNamed) {
  EXPECT_THAT(Message(CheckShown({odd::CertificateWith(odd::RsaKey(4097, 17))})),
              HasSubstr("an RSA key of over 4,096 bits"));
}

TEST(Authority, RefusesAKeyOfAnother) {
  const auto one = Authority::Create("one", 1);
  const auto two = Authority::Create("two", 1);
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_TRUE(Authority::Load((*one)->credentials()).ok());
  const auto mixed =
      Authority::Load({(*one)->credentials().certificate_pem, (*two)->credentials().key_pem});
  EXPECT_THAT(Message(mixed.status()), HasSubstr("is not the key of"));
  EXPECT_FALSE(Authority::Load({"no PEM", (*two)->credentials().key_pem}).ok());
  EXPECT_FALSE(Authority::Load({(*one)->credentials().certificate_pem, ""}).ok());
}

TEST(Authority, ReadsFilesAsTheServerDoes) {
  const auto made = Authority::Create("one", 1);
  ASSERT_TRUE(made.ok());
  const auto said = [](const std::string& certificate, const std::string& key) {
    return Message(Authority::Load({certificate, key}).status());
  };
  const auto& [certificate, key] = (*made)->credentials();
  EXPECT_EQ(said("notes\n" + certificate, testing::EcparamKey(key)), "");
  EXPECT_THAT(said(certificate, testing::LockedKey(key)),
              HasSubstr("the authority's key: PEM block 1, from line 1, is a private key behind"));
  EXPECT_THAT(said(certificate + testing::BlockOf("CERTIFICATE"), key),
              HasSubstr("the authority's certificate: PEM block 2, from line "));
}

TEST(Directory, WritesFilesForTheirOwnerOnly) {
  const Folder folder;
  const Directory directory(folder / "new/pki");
  ASSERT_TRUE(directory.Prepare().ok());
  ASSERT_TRUE(directory.Write("r1", {"certificate", "key"}, Existing::kRefuse).ok());
  EXPECT_EQ(ModeOf(directory.path()), 0700U);
  EXPECT_EQ(ModeOf(directory.CertificatePath("r1")), 0600U);
  EXPECT_EQ(ModeOf(directory.KeyPath("r1")), 0600U);
  const auto read = directory.Read("r1");
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->certificate_pem, "certificate");
  EXPECT_EQ(read->key_pem, "key");
  // Nothing else is left behind.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 2);
}

TEST(Directory, AFolderIntoWhichOthersMayWriteIsRefused) {
  const Folder folder;
  const std::string path = folder / "pki";
  ASSERT_EQ(mkdir(path.c_str(), 0700), 0);
  for (const mode_t mode : {0770U, 0703U, 01777U}) {
    ASSERT_EQ(chmod(path.c_str(), mode), 0);
    const absl::Status refused = Directory(path).Prepare();
    EXPECT_TRUE(absl::IsFailedPrecondition(refused)) << refused;
    EXPECT_THAT(Message(refused), HasSubstr(path + ": others than the folder's owner may write"));
    EXPECT_THAT(Message(refused), HasSubstr("chmod go-w " + path));
  }
  ASSERT_EQ(chmod(path.c_str(), 0755), 0);
  EXPECT_TRUE(Directory(path).Prepare().ok());
}

TEST(Directory, AFolderOfAnotherUserIsRefused) {
  constexpr uid_t kCaller = 1000;
  constexpr uid_t kAnother = 4711;
  const auto said = [](uid_t owner, uid_t caller) {
    return Message(CheckFolder("/keys", {.owner = owner, .mode = 0755}, caller));
  };
  EXPECT_EQ(said(0, kCaller), "");
  EXPECT_EQ(said(kCaller, kCaller), "");
  EXPECT_EQ(said(kAnother, kCaller),
            "/keys: the folder belongs to user 4711, who could replace the files; name another, or "
            "give it to this user: chown 1000 /keys");
  EXPECT_THAT(said(kAnother, 0), HasSubstr("chown 0 /keys"));
}

TEST(Directory, RemovesWhatACallLeftThatWasKilledAsItWrote) {
  const Folder folder;
  const Directory directory(folder / "pki");
  ASSERT_TRUE(directory.Prepare().ok());
  const std::filesystem::path path(directory.path());
  for (const Existing existing : {Existing::kRefuse, Existing::kReplace}) {
    for (const char* left : {".r1.key.new", ".r1.crt.new"}) std::ofstream(path / left) << "half";
    const absl::Status written = directory.Write("r1", {"certificate", "key"}, existing);
    ASSERT_TRUE(written.ok()) << written;
    EXPECT_EQ(directory.Read("r1")->key_pem, "key");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path), {}), 2);
  }
}

TEST(Directory, ALinkThatACallLeftIsNotTheFile) {
  const Folder folder;
  const Directory directory(folder / "pki");
  ASSERT_TRUE(directory.Prepare().ok());
  ASSERT_TRUE(directory.Write("r1", {"old", "old key"}, Existing::kRefuse).ok());
  const std::filesystem::path aside = std::filesystem::path(directory.path()) / ".r1.key.new";
  std::filesystem::create_hard_link(directory.KeyPath("r1"), aside);
  EXPECT_TRUE(absl::IsAlreadyExists(directory.Write("r1", {"c", "k"}, Existing::kRefuse)));
  EXPECT_EQ(directory.Read("r1")->key_pem, "old key");
  ASSERT_TRUE(directory.Write("r1", {"c", "k"}, Existing::kReplace).ok());
  EXPECT_EQ(directory.Read("r1")->key_pem, "k");
  EXPECT_FALSE(std::filesystem::exists(aside));
}

TEST(Directory, ACallInAContainerDoesNotMeetTheFileOfTheOneBefore) {
  const Folder folder;
  const Directory directory(folder / "pki");
  ASSERT_TRUE(directory.Prepare().ok());
  // The only process of a container has the same number each time.
  std::ofstream(directory.KeyPath("r1") + "." + std::to_string(getpid()) + ".new") << "half";
  EXPECT_TRUE(directory.Write("r1", {"certificate", "key"}, Existing::kRefuse).ok());
}

TEST(Directory, ReplacesOnlyWhenAsked) {
  const Folder folder;
  const Directory directory(folder / "pki");
  ASSERT_TRUE(directory.Prepare().ok());
  ASSERT_TRUE(directory.Write("r1", {"old", "old key"}, Existing::kRefuse).ok());
  const absl::Status refused = directory.Write("r1", {"new", "new key"}, Existing::kRefuse);
  EXPECT_TRUE(absl::IsAlreadyExists(refused));
  EXPECT_THAT(Message(refused), HasSubstr(directory.CertificatePath("r1")));
  EXPECT_EQ(directory.Read("r1")->certificate_pem, "old");
  ASSERT_TRUE(directory.Write("r1", {"new", "new key"}, Existing::kReplace).ok());
  EXPECT_EQ(directory.Read("r1")->certificate_pem, "new");
  EXPECT_EQ(directory.Read("r1")->key_pem, "new key");
}

TEST(Directory, ACertificateWithoutItsKeyIsNotReplacedEither) {
  const Folder folder;
  const Directory directory(folder / "pki");
  ASSERT_TRUE(directory.Prepare().ok());
  std::ofstream(directory.CertificatePath("r1")) << "somebody's";
  EXPECT_TRUE(absl::IsAlreadyExists(directory.Write("r1", {"c", "k"}, Existing::kRefuse)));
  EXPECT_FALSE(std::filesystem::exists(directory.KeyPath("r1")));
}

TEST(Directory, ErrorsNameThePath) {
  const Folder folder;
  ASSERT_EQ(mkfifo((folder / "pipe.crt").c_str(), 0600), 0);
  EXPECT_THAT(Message(Directory(folder / "").Read("pipe").status()),
              HasSubstr("pipe.crt: it is not a regular file"));
  const Directory missing(folder / "missing");
  EXPECT_TRUE(absl::IsNotFound(missing.LoadAuthority().status()));
  EXPECT_THAT(Message(missing.LoadAuthority().status()), HasSubstr(missing.CertificatePath("ca")));
  std::ofstream(folder / "file") << "not a folder";
  EXPECT_THAT(Message(Directory(folder / "file").Prepare()), HasSubstr(folder / "file"));
  std::ofstream(folder / "big.crt") << std::string(kPemBytesMax + 1, 'x');
  EXPECT_THAT(Message(Directory(folder / "").Read("big").status()), HasSubstr("big.crt"));
}

}  // namespace
}  // namespace uplink::pki
