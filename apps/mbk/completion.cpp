#include "apps/mbk/completion.h"

#include <memory>

#include "apps/mbk/commands.h"
#include "apps/mbk/option_checks.h"
#include "apps/mbk/output.h"

namespace mbk::app {
namespace {

struct Arguments {
  std::string shell;
  Output output;
};

int run(const Arguments& arguments, CLI::App& root) {
  const CommandText text = describe(root);
  const std::string script = arguments.shell == "bash"  ? bash_completion(text)
                             : arguments.shell == "zsh" ? zsh_completion(text)
                                                        : fish_completion(text);
  if (auto ok = arguments.output.check({}); !ok) return report_error(ok.error());
  if (auto ok = arguments.output.write(script); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

std::string single_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

Action add_completion(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = add_command(app, "completion", "a script that lets the shell complete commands and options");
  command->footer(
      "Examples:\n"
      "  mbk completion bash --out ~/.local/share/bash-completion/completions/mbk\n"
      "      or, for one shell alone: source <(mbk completion bash)\n"
      "  mbk completion zsh --out ~/.zfunc/_mbk\n"
      "      with fpath+=~/.zfunc before compinit in ~/.zshrc\n"
      "  mbk completion fish --out ~/.config/fish/completions/mbk.fish\n\n"
      "Where mbk came as a package, or by 'cmake --install', the scripts are in place.");
  const std::vector<std::string> shells = {"bash", "zsh", "fish"};
  command->add_option("SHELL", arguments->shell, "bash, zsh or fish")->required()->check(one_of(shells));
  arguments->output.add_options(*command);
  return [arguments, &app] { return run(*arguments, app); };
}

}  // namespace mbk::app
