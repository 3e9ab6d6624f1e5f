#include "apps/mbk/readers_option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "apps/mbk/option_checks.h"

namespace mbk::app {

void add_readers_option(CLI::App& command, std::optional<Readers>& readers) {
  std::vector<std::string> words;
  for (const auto& [word, value] : kReaders) words.emplace_back(word);
  const auto take = [&readers](const std::string& word) {
    readers = std::ranges::find(kReaders, word, &decltype(kReaders)::value_type::first)->second;
  };
  command.add_option_function<std::string>("--readable-by", take, "who may read the recording (owner)")
      ->type_name(fmt::format("{}", fmt::join(words, "|")))
      ->check(one_of(words));
}

}  // namespace mbk::app
