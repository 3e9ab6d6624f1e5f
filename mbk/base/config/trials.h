#pragma once

#include <filesystem>
#include <string_view>
#include <type_traits>
#include <vector>

#include "mbk/base/config/document.h"

namespace mbk::config {

/// What read(root, name) makes of each trial of a file, in the file's order (Document::trials). Every trial and the
/// whole file are finished, so that a key which nobody asked for is an error.
/// @param file  how messages call it
/// @param read  (const Section& root, const std::string& name) → Result<T>
/// @fails  data: as Document::parse, trials and finish, and as read; the first of them.
template <class Read>
auto read_trials(std::string_view text, const std::filesystem::path& file, const Read& read)
    -> Result<std::vector<typename std::invoke_result_t<Read, Section, std::string>::value_type>> {
  const auto document = Document::parse(text, file.string());
  if (!document) return tl::unexpected(document.error());
  const auto trials = document->trials();
  if (!trials) return tl::unexpected(trials.error());
  std::vector<typename std::invoke_result_t<Read, Section, std::string>::value_type> values;
  for (const Trial& trial : *trials) {
    auto value = read(trial.document.root(), trial.name);
    if (!value) return tl::unexpected(value.error());
    if (auto ok = trial.document.finish(); !ok) return tl::unexpected(ok.error());
    values.push_back(std::move(*value));
  }
  if (auto ok = document->finish(); !ok) return tl::unexpected(ok.error());
  return values;
}

}  // namespace mbk::config
