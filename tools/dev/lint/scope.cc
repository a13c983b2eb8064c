// A plugin of clang-tidy: checks then walk our own declarations alone.
//
// clang-tidy matches every check against all that a file includes, and drops at the end what it
// found in foreign headers: four fifths of its time. Here the walk begins at the top-level
// declarations outside of system headers, which is where every finding that is reported lies.

#include <memory>
#include <string>
#include <vector>

#include <clang/AST/ASTConsumer.h>
#include <clang/AST/ASTContext.h>
#include <clang/Basic/SourceManager.h>
#include <clang/Frontend/FrontendPluginRegistry.h>

namespace uplink::lint {
namespace {

class Scope final : public clang::ASTConsumer {
 public:
  void HandleTranslationUnit(clang::ASTContext& context) override {
    const clang::SourceManager& sources = context.getSourceManager();
    std::vector<clang::Decl*> ours;
    // "noload": what a precompiled header holds is foreign, and is left where it is.
    for (clang::Decl* declaration : context.getTranslationUnitDecl()->noload_decls()) {
      const clang::SourceLocation at = sources.getExpansionLoc(declaration->getLocation());
      if (at.isValid() && !sources.isInSystemHeader(at)) ours.push_back(declaration);
    }
    context.setTraversalScope(ours);
  }
};

class ScopeAction final : public clang::PluginASTAction {
 protected:
  std::unique_ptr<clang::ASTConsumer> CreateASTConsumer(clang::CompilerInstance& /*compiler*/,
                                                        llvm::StringRef /*file*/) override {
    return std::make_unique<Scope>();
  }

  bool ParseArgs(const clang::CompilerInstance& /*compiler*/,
                 const std::vector<std::string>& /*arguments*/) override {
    return true;
  }

  ActionType getActionType() override { return AddBeforeMainAction; }
};

const clang::FrontendPluginRegistry::Add<ScopeAction> kRegistration(
    "uplink-lint-scope", "checks walk our own declarations alone");

}  // namespace
}  // namespace uplink::lint
