#include "apps/mbk/terminal/completion.h"

#include <memory>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/word_options.h"

namespace mbk::app {
namespace {

enum class Shell { bash, zsh, fish };

constexpr auto word_table(Shell) {
  using enum Shell;
  return std::to_array<Word<Shell>>({{bash, "bash"}, {zsh, "zsh"}, {fish, "fish"}});
}

struct CompletionArguments {
  Shell shell = Shell::bash;
  Output output;
};

int run(const CompletionArguments& arguments, Command root) {
  const CommandText text = describe(root);
  const std::string script = arguments.shell == Shell::bash  ? bash_completion(text)
                             : arguments.shell == Shell::zsh ? zsh_completion(text)
                                                             : fish_completion(text);
  if (auto ok = arguments.output.check({}); !ok) return report_error(ok.error());
  if (auto ok = arguments.output.write(script, {}); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

std::string single_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

Action add_completion(Command app) {
  auto arguments = std::make_shared<CompletionArguments>();
  const Command command =
      app.add_command("completion", "print a script that lets the shell complete commands and options");
  command.footer(
      "Examples:\n"
      "  mbk completion bash --out ~/.local/share/bash-completion/completions/mbk\n"
      "      or, for the current shell only: source <(mbk completion bash)\n"
      "  mbk completion zsh --out ~/.zfunc/_mbk\n"
      "      with fpath+=~/.zfunc before compinit in ~/.zshrc\n"
      "  mbk completion fish --out ~/.config/fish/completions/mbk.fish\n\n"
      "If mbk was installed from a package or with 'cmake --install', the scripts are already installed.");
  add_choice(command, "SHELL", arguments->shell, "the shell: bash, zsh or fish").type_name("TEXT").required();
  arguments->output.add_options(command);
  return [arguments, app] { return run(*arguments, app); };
}

}  // namespace mbk::app
