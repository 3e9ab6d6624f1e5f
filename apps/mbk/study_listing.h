#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "apps/mbk/study_options.h"
#include "mbk/study/store/study_list.h"

/// What the commands share that show a study under one analysis.
namespace mbk::app {

struct AnalysisArguments {
  StudyArguments study;
  OutputArguments output;
  std::optional<std::int64_t> analysis;
};

/// Adds --analysis.
void add_analysis_option(CLI::App& command, AnalysisArguments& arguments);

/// Opens the study into `study` and lists it.
[[nodiscard]] Result<store::StudyList> listed_study(const AnalysisArguments& arguments,
                                                    std::optional<store::Store>& study);

/// Title, how many recordings there are in which state, and the analyses.
[[nodiscard]] std::string study_head_text(const store::StudyList& list);

}  // namespace mbk::app
