#include "apps/mbk/terminal/manual_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <regex>

#include "apps/mbk/terminal/help_footer.h"
#include "apps/mbk/options/output.h"

namespace mbk::app {
namespace {

/// Text as roff prints it, sign by sign; a line never begins a request.
std::string roff(const std::string& text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    line_begins = c == '\n';
    switch (c) {
      case '\\':
        out += "\\e";
        break;
      case '-':
        out += "\\-";
        break;
      case '\'':
        out += "\\(aq";
        break;
      case '^':
        out += "\\(ha";
        break;
      case '~':
        out += "\\(ti";
        break;
      case '`':
        out += "\\(ga";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// Text with each sentence on a line of its own, as roff wants it to space them.
std::string prose(const std::string& text) {
  static const std::regex kSentenceEnd(R"(([a-z0-9)][.:]) +([A-Z0-9]))");
  return roff(std::regex_replace(text, kSentenceEnd, "$1\n$2")) + "\n";
}

/// "what a command does" as a sentence.
std::string sentence(std::string text) {
  if (text.empty()) return "";
  if (text.front() >= 'a' && text.front() <= 'z') text.front() = static_cast<char>(text.front() - 'a' + 'A');
  return prose(text + ".");
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}
std::string italic(const std::string& text) {
  return "\\fI" + roff(text) + "\\fR";
}

/// "default|reference": words that are meant as they stand are bold, what stands for a value is italic.
std::string placeholder(const OptionText& option) {
  std::string out, part;
  const auto finish = [&] {
    const bool literal = std::ranges::find(option.values.words, part) != option.values.words.end();
    if (!part.empty()) out += literal ? bold(part) : italic(part);
    part.clear();
  };
  for (const char c : option.value) {
    if (c != '|') {
      part += c;
      continue;
    }
    finish();
    out += '|';
  }
  finish();
  return out + (option.repeats ? "..." : "");
}

std::string entry(const OptionText& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + bold(name);
  if (!option.value.empty()) names += (names.empty() ? "" : " ") + placeholder(option);
  std::string description = option.description;
  if (!option.needs.empty()) description += fmt::format("; only with {}", fmt::join(option.needs, ", "));
  if (!option.excludes.empty()) description += fmt::format("; not with {}", fmt::join(option.excludes, ", "));
  return ".TP\n" + names + "\n" + prose(description);
}

std::string upper_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c; });
  return text;
}

/// What NAME says after the dash: "mbk measures M: the rest" gives "measures M".
std::string summary(const CommandText& command, const HelpFooter& about) {
  std::string text = about.paragraphs.empty() ? "" : about.paragraphs.front();
  if (const std::string subject = command.name() + " "; text.starts_with(subject)) {
    text = text.substr(subject.size(), text.find(':') - subject.size());
  }
  return text;
}

std::string synopsis(const CommandText& command) {
  std::string text = ".SH SYNOPSIS\n" + bold(command.joined(" "));
  if (!command.options.empty()) text += " [" + italic("OPTIONS") + "]";
  if (!command.commands.empty()) text += " " + italic("COMMAND");
  for (const OptionText& one : command.positionals) {
    const std::string name = italic(one.value) + (one.repeats ? "..." : "");
    text += one.required ? " " + name : " [" + name + "]";
  }
  return text + "\n";
}

std::string paragraphs(const std::vector<std::string>& texts) {
  std::string out;
  for (const std::string& text : texts) out += (out.empty() ? "" : ".PP\n") + prose(text);
  return out;
}

/// Groups in the order in which --help shows them: its own two first.
std::string options(const CommandText& command) {
  std::vector<std::string> groups = {"Options"};
  for (const OptionText& option : command.options) {
    if (std::ranges::find(groups, option.group) == groups.end()) groups.push_back(option.group);
  }
  std::string text;
  if (!command.positionals.empty()) {
    text += ".SH ARGUMENTS\n";
    for (const OptionText& one : command.positionals) text += entry(one);
  }
  text += ".SH OPTIONS\n";
  for (const std::string& group : groups) {
    if (group != groups.front()) text += ".SS " + roff(group) + "\n";
    for (const OptionText& option : command.options) {
      if (option.group == group) text += entry(option);
    }
  }
  return text;
}

std::string examples(const std::vector<Example>& all) {
  if (all.empty()) return "";
  std::string text = ".SH EXAMPLES\n";
  bool first = true;
  for (const Example& one : all) {
    text += (first ? ".EX\n" : ".PP\n.EX\n") + roff(one.command) + "\n.EE\n";
    if (!one.remark.empty()) text += ".RS 4\n" + prose(one.remark) + ".RE\n";
    first = false;
  }
  return text;
}

/// "0 fine, 2 wrong usage." as a list.
std::string exit_status(const std::string& codes) {
  static const std::regex kCode(R"((\d+) ([^\d]+?)(?:, (?=\d)|\.?$))");
  std::string text = ".SH EXIT STATUS\n";
  for (std::sregex_iterator at(codes.begin(), codes.end(), kCode), end; at != end; ++at) {
    text += ".TP\n" + bold((*at)[1]) + "\n" + prose((*at)[2]);
  }
  return text;
}

std::string reference(const std::string& page) {
  return "\\fB" + roff(page) + "\\fR(1)";
}

/// The command above it, those below it, those beside it.
std::string see_also(const CommandText& command, const CommandText& root) {
  std::vector<std::string> pages;
  const CommandText* above = nullptr;
  for_each_command(root, [&](const CommandText& one) {
    for (const CommandText& below : one.commands) {
      if (below.path == command.path) above = &one;
    }
  });
  if (above != nullptr) {
    pages.push_back(above->joined("-"));
    for (const CommandText& beside : above->commands) {
      if (beside.path != command.path) pages.push_back(beside.joined("-"));
    }
  }
  for (const CommandText& below : command.commands) pages.push_back(below.joined("-"));
  std::string text = ".SH SEE ALSO\n";
  for (std::size_t i = 0; i < pages.size(); ++i) text += reference(pages[i]) + (i + 1 < pages.size() ? ",\n" : "\n");
  return text;
}

}  // namespace

std::string manual_file(const CommandText& command) {
  return command.joined("-") + ".1";
}

std::string manual_page(const CommandText& command, const CommandText& root, const std::string& version) {
  const HelpFooter about = parse_footer(command.description), footer = parse_footer(command.footer);
  const std::string name = command.joined("-");
  // No date: a page belongs to a version, and the same version gives the same bytes.
  std::string page = fmt::format(".TH {} 1 \"\" \"mbk {}\" \"mbk manual\"\n.SH NAME\n{} \\- {}\n",
                                 roff(upper_case(name)), version, roff(name), roff(summary(command, about)));
  page += synopsis(command) + ".SH DESCRIPTION\n";
  page += &command == &root ? paragraphs(about.paragraphs) : sentence(command.description);
  if (!footer.paragraphs.empty()) page += ".PP\n" + paragraphs(footer.paragraphs);
  if (!command.commands.empty()) {
    page += ".SH COMMANDS\n";
    for (const CommandText& below : command.commands) {
      page += ".TP\n" + reference(below.joined("-")) + "\n" + prose(below.description);
    }
  }
  page += options(command);
  for (const HelpFooter::List& list : footer.lists) {
    page += ".SH " + roff(upper_case(list.heading)) + "\n";
    for (const auto& [word, remark] : list.entries) page += ".TP\n" + bold(word) + "\n" + prose(remark);
  }
  std::vector<Example> all = about.examples;
  all.insert(all.end(), footer.examples.begin(), footer.examples.end());
  return page + examples(all) + exit_status(footer.exit_codes.empty() ? kExitCodes : footer.exit_codes) +
         see_also(command, root);
}

}  // namespace mbk::app
