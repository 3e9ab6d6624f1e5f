#include "mbk/experiment/console/texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "mbk/base/config/document.h"

namespace mbk::console {
namespace {

Texts::Sentences sentences_in(const config::Section& section, bool all) {
  Texts::Sentences sentences;
  for (const std::string_view key : kTextKeys) {
    if (!all && !section.has(key)) continue;
    std::string& sentence = sentences[std::string(key)] = section.required_text(key);
    if (section.has(key) && sentence.empty()) section.reject(key, "is empty");
  }
  return sentences;
}

Result<Texts> texts_of(const config::Document& document, const std::vector<std::string>& trials) {
  const config::Section root = document.root();
  Texts texts;
  texts.language = root.required_text("language");
  texts.sentences = sentences_in(root, true);
  for (const std::string& name : trials) {
    const config::Section own = root.section("trial").section(name);
    if (own.given()) texts.trials[name] = sentences_in(own, false);
  }
  MBK_TRY(document.finish());
  return texts;
}

}  // namespace

Result<Texts> read_texts(std::string_view text, std::string_view file, const std::vector<std::string>& trials) {
  const auto document = MBK_TRY(config::Document::parse(text, file));
  return texts_of(document, trials);
}

Result<Texts> find_texts(const std::string& name_or_file, const std::vector<std::string>& trials) {
  const auto ready = ready_texts();
  const auto found = std::ranges::find(ready, name_or_file, &ReadyTexts::name);
  if (found != ready.end()) return read_texts(found->text, std::string(found->name) + ".toml", trials);
  std::error_code ignored;
  if (!std::filesystem::exists(name_or_file, ignored)) {
    std::string names;
    for (const ReadyTexts& one : ready) names += fmt::format("{}{}", names.empty() ? "" : ", ", one.name);
    return bad_data(fmt::format("no such file, and no texts of that name ({})", names),
                    "copy examples/texts/en.toml and put your own words in it", name_or_file);
  }
  const auto document = MBK_TRY(config::Document::read(name_or_file));
  return texts_of(document, trials);
}

}  // namespace mbk::console
