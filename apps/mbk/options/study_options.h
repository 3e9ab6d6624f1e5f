#pragma once

#include <filesystem>
#include <optional>

#include "apps/mbk/options/measure_options.h"
#include "apps/mbk/terminal/command.h"
#include "mbk/base/core/counted.h"
#include "mbk/study/store/store.h"
#include "mbk/study/workflow/measuring.h"

/// What the commands of `mbk study` share.
namespace mbk::app {

/// Which study, and who asks.
struct StudyArguments {
  std::optional<std::filesystem::path> folder;
  store::Role role = store::Role::analyst;
};

/// Adds --study.
void add_study_option(Command command, StudyArguments& arguments);
/// Adds --role.
void add_choice_of_role(Command command, StudyArguments& arguments);
/// Adds --study and --role, for commands that the log tells of.
void add_study_and_role(Command command, StudyArguments& arguments);

/// The study of --study, or the one that the current folder is in.
[[nodiscard]] Result<store::Store> open_study(const StudyArguments& arguments);

/// Adds the options of `mbk measure` for measuring one recording, and --ranges.
void add_measuring_options(Command command, request::MeasureRequest& measuring);

}  // namespace mbk::app
