#include "mbk/present/request/named_robot.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mbk/files/contents/read_text.h"
#include "mbk/model/robot_file/robot_file.h"
#include "mbk/present/result/robot_json.h"

namespace mbk::request {
namespace {

/// The robot that a result describes, with the numbers that it holds.
Result<robot::RobotDescription> from_result(const std::filesystem::path& file) {
  const auto text = MBK_TRY(read_text(file));
  const auto stored = result::robot_from_json(text);
  if (!stored) return tl::unexpected(stored.error().in(file.string()));
  auto description = stored->description.empty()
                         ? robot_file::thesis_robot()
                         : robot_file::parse_robot_description(stored->description, stored->urdf, file.string());
  if (!description) return description;
  robot::DynamicModel& model = description->model;
  model.drive = stored->drive;
  std::vector<std::string> names;
  for (const robot::Coefficient& one : model.coefficients()) names.push_back(one.name);
  if (names != stored->names) {
    return bad_data("its parameters are not those of the robot that it describes",
                    "write it anew with 'mbk robot identify --json'", file.string());
  }
  model.parameters = stored->parameters;
  model.covariance = stored->covariance;
  model.delay = stored->delay;
  description->source = file.string();
  description->unstated.clear();
  description->impossible.clear();
  description->usable = stored->usable;
  description->warnings = stored->warnings;
  return description;
}

}  // namespace

Result<robot::RobotDescription> describe_robot(const std::optional<std::filesystem::path>& file) {
  if (!file) return robot_file::thesis_robot();
  return file->extension() == ".json" ? from_result(*file) : robot_file::read_robot_description(*file);
}

Result<robot::DynamicModel> robot_of(const std::optional<std::filesystem::path>& file) {
  // Table A.1 has viscous friction, and says nothing of what else may resist.
  auto description =
      MBK_TRY(file ? describe_robot(file)
                   : robot_file::parse_robot_description("[robot]\nkind = \"planar\"\n[drive]\nterms = [\"viscous\"]\n",
                                                         "", "the robot of the thesis"));
  if (!description.unstated.empty()) {
    return bad_data(fmt::format("it does not say {}", fmt::join(description.unstated, ", ")),
                    "find them with 'mbk robot identify FILE... --robot ROBOT --json', or state them", file->string());
  }
  if (!description.impossible.empty()) {
    return bad_data(fmt::format("{}", fmt::join(description.impossible, "; ")),
                    "correct it, or find it with 'mbk robot identify FILE... --robot ROBOT --json'", file->string());
  }
  if (!description.usable) {
    return fail(ErrorKind::not_usable,
                fmt::format("its dynamics are not usable ({})", fmt::join(description.warnings, ", ")),
                "identify the robot again, as the file's warnings advise", file->string());
  }
  return std::move(description.model);
}

}  // namespace mbk::request
