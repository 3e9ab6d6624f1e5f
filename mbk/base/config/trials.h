#pragma once

#include <filesystem>
#include <string_view>
#include <type_traits>
#include <vector>

#include "mbk/base/config/document.h"

namespace mbk::config {

/// The result of read(root, name) for each trial of a file, in the order of the file (Document::trials). Every trial
/// and the whole file are finished, so that an unknown key is an error.
/// @param file  its name in messages
/// @param read  (const Section& root, const std::string& name) → Result<T>
/// @fails  data: as Document::parse, trials and finish, and as read; the first of them.
template <class Read>
auto read_trials(std::string_view text, const std::filesystem::path& file, const Read& read)
    -> Result<std::vector<typename std::invoke_result_t<Read, Section, std::string>::value_type>> {
  const auto document = MBK_TRY(Document::parse(text, file.string()));
  const auto trials = MBK_TRY(document.trials());
  std::vector<typename std::invoke_result_t<Read, Section, std::string>::value_type> values;
  for (const Trial& trial : trials) {
    auto value = MBK_TRY(read(trial.document.root(), trial.name));
    MBK_TRY(trial.document.finish());
    values.push_back(std::move(value));
  }
  MBK_TRY(document.finish());
  return values;
}

}  // namespace mbk::config
