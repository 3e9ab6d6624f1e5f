#include "mbk/model/robot_file/robot_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "mbk/base/config/document.h"
#include "mbk/base/config/text_file.h"
#include "mbk/model/robot/planar_mechanism.h"
#include "mbk/model/robot/serial_chain.h"
#include "mbk/model/robot/single_joint.h"
#include "mbk/model/robot_file/drive_keys.h"
#include "mbk/model/robot_file/planar_keys.h"

namespace mbk::robot_file {
namespace {

using config::Section;
using robot::DriveTerms;
using robot::RobotDescription;
using robot::SerialChain;

struct Urdf {
  std::string text;
  std::string where;  ///< how messages call it
};

/// Gives a URDF by the name that a TOML file calls it.
using FindUrdf = std::function<Result<Urdf>(const std::string& name)>;

constexpr std::size_t kLargestUrdf = 10'000'000;

Result<std::string> text_of(const std::filesystem::path& file) {
  auto text = config::read_text_file(file, kLargestUrdf);
  if (!text) return text;
  if (text->size() > kLargestUrdf)
    return bad_data("the file is larger than 10 MB", "check the name: a robot URDF is smaller", file.string());
  return text;
}

Result<Urdf> urdf_of(const std::filesystem::path& file) {
  auto text = text_of(file);
  if (!text) return tl::unexpected(text.error());
  return Urdf{*std::move(text), file.string()};
}

/// Bodies and drives of a kind of robot before [drive] is read.
struct Bodies {
  std::shared_ptr<const robot::Mechanism> mechanism;
  Vector phi;
  std::vector<bool> stated;
  std::vector<std::string> impossible;
  std::vector<std::string> drives_elsewhere;  ///< words of drive terms whose values [drive] does not hold
  std::function<void(DriveValues&)> add_drives = [](DriveValues& /*drives*/) {};

  Bodies(std::shared_ptr<const robot::Mechanism> robot, Vector values, bool are_stated = true)
      : mechanism(std::move(robot)), phi(std::move(values)), stated(static_cast<std::size_t>(phi.size()), are_stated) {}
};

/// One number for both joints, because the drives share it.
double shared(const Section& s, const char* key, double first, double second) {
  if (first != second) s.reject(key, "the two joints differ", "write the same value for both");
  return first;
}

Bodies read_planar(const Section& s, DriveTerms& terms) {
  const robot::PlanarRobot planar = read_planar_robot(s);
  robot::PlanarMechanism::Options options;
  options.geometry = planar.geometry;
  options.up = s.optional_number("up_deg");
  const robot::Inertia& inertia = planar.inertia;
  Vector phi(options.up ? 5 : 3);
  phi.head<3>() << inertia.alpha1, inertia.alpha2, inertia.alpha3;
  if (options.up) phi.tail<2>() = s.vector2("gravity_Nm", Eigen::Vector2d::Zero());
  Bodies bodies(std::make_shared<const robot::PlanarMechanism>(options), phi);
  if (options.up && !s.has("gravity_Nm")) bodies.stated[3] = bodies.stated[4] = false;
  if (!options.up && s.has("gravity_Nm")) s.reject("gravity_Nm", "the plane is horizontal", "add up_deg");

  const auto& friction = planar.friction;
  terms.smoothing = shared(s, "smoothing_rad_per_s", friction[0].smoothing, friction[1].smoothing);
  terms.stribeck_velocity =
      shared(s, "stribeck_velocity_rad_per_s", friction[0].stribeck_velocity, friction[1].stribeck_velocity);
  const auto check_term = [&](const char* key, bool requested, const char* word) {
    if (!requested && s.has(key)) {
      s.reject(key, fmt::format("\"{}\" is not among the drive terms", word), "add it to terms in [drive]");
    }
    return s.has(key);
  };
  check_term("viscous_Nms_per_rad", terms.viscous, "viscous");
  const bool coulomb = check_term("coulomb_Nm", terms.coulomb, "coulomb");
  const bool breakaway = check_term("breakaway_Nm", terms.stribeck, "stribeck");
  bodies.drives_elsewhere = {"viscous", "coulomb", "stribeck"};
  bodies.add_drives = [friction, coulomb, breakaway](DriveValues& drives) {
    for (int joint = 0; joint < 2; ++joint) {
      const robot::JointFriction& one = friction[static_cast<std::size_t>(joint)];
      drives.set(&DriveTerms::viscous, joint, one.viscous);
      if (coulomb) drives.set(&DriveTerms::coulomb, joint, one.coulomb);
      if (breakaway) drives.set(&DriveTerms::stribeck, joint, std::max(0.0, one.breakaway - one.coulomb));
    }
  };
  return bodies;
}

Bodies read_one_axis(const Section& s) {
  if (!s.has("slides")) {
    s.reject("slides", "the type of the drive, sliding or turning, is missing",
             "write slides = true or slides = false");
  }
  robot::SingleJoint::Options options;
  options.slides = s.flag("slides", true);
  const char* limits = options.slides ? "limits_mm" : "limits_deg";
  const Eigen::Vector2d range = s.vector2(limits, {options.low, options.high});
  if (!(range[0] < range[1])) s.reject(limits, "the first value is not below the second", "write [low, high]");
  options.low = range[0];
  options.high = range[1];
  const auto inertia = s.optional_number(options.slides ? "mass_kg" : "inertia_kg_m2", config::above(0));
  return {std::make_shared<const robot::SingleJoint>(options), Vector::Constant(1, inertia.value_or(0.0)),
          inertia.has_value()};
}

SerialChain::Options read_chain_options(const Section& s) {
  SerialChain::Options options;
  options.base_link = s.text("base_link", "");
  options.tip_link = s.text("tip_link", "");
  const auto vector = [&](const char* key, const Eigen::Vector3d& fallback) -> Eigen::Vector3d {
    return Eigen::Map<const Eigen::Vector3d>(
        s.numbers(key, {fallback[0], fallback[1], fallback[2]}, config::any(), 3).data());
  };
  options.gravity = vector("gravity_m_per_s2", options.gravity);
  options.tool = vector("tool_mm", options.tool);
  using Axis = SerialChain::Axis;
  options.hand_axes = s.choices<Axis>("hand_axes", {{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}}, options.hand_axes);
  if (options.hand_axes.empty() || options.hand_axes.size() > 3) {
    s.reject("hand_axes", "the hand must be measured along one to three axes", R"(choose from "x", "y", "z")");
    options.hand_axes = SerialChain::Options().hand_axes;
  }
  return options;
}

/// How the recording counts the joints: zero_deg one for each that turns, zero_mm for each that slides, signs for all.
void read_counting(const Section& s, const SerialChain& chain, SerialChain::Options& options) {
  const auto joints = static_cast<std::size_t>(chain.joints());
  options.zero.assign(joints, 0.0);
  for (const bool sliding : {false, true}) {
    const char* key = sliding ? "zero_mm" : "zero_deg";
    std::vector<std::size_t> those;
    for (std::size_t joint = 0; joint < joints; ++joint) {
      if (chain.slides(static_cast<int>(joint)) == sliding) those.push_back(joint);
    }
    if (those.empty()) continue;
    const std::vector<double> zeros = s.numbers(key, std::vector<double>(those.size()), config::any(), those.size());
    for (std::size_t k = 0; k < those.size(); ++k) options.zero[those[k]] = zeros[k];
  }
  options.sign.clear();
  for (const double sign : s.numbers("signs", std::vector<double>(joints, 1.0), config::any(), joints)) {
    if (sign != 1.0 && sign != -1.0) s.reject("signs", fmt::format("{:g} is neither 1 nor -1", sign));
    options.sign.push_back(sign < 0.0 ? -1 : 1);
  }
}

Result<Bodies> read_urdf(const Section& s, const Urdf& urdf) {
  SerialChain::Options options = read_chain_options(s);
  const auto read = [&] {
    return SerialChain::from_urdf(urdf.text, options).map_error([&](const Error& problem) {
      Error in_file = problem.in(urdf.where);
      in_file.kind = ErrorKind::data;
      return in_file;
    });
  };
  const auto uncounted = read();  // which joints there are, before their zeros are read
  if (!uncounted) return tl::unexpected(uncounted.error());
  read_counting(s, **uncounted, options);
  const auto chain = read();
  if (!chain) return tl::unexpected(chain.error());
  Bodies bodies(*chain, (*chain)->stated_coefficients());
  bodies.impossible = (*chain)->impossible();
  bodies.add_drives = [chain = *chain](DriveValues& drives) {
    for (int joint = 0; joint < chain->joints(); ++joint) {
      const SerialChain::Joint& one = chain->joint_descriptions()[static_cast<std::size_t>(joint)];
      if (one.damping != 0.0) drives.set(&DriveTerms::viscous, joint, one.damping);
      if (one.friction != 0.0) drives.set(&DriveTerms::coulomb, joint, one.friction);
    }
  };
  return bodies;
}

Result<RobotDescription> described(const config::Document& document, const FindUrdf& find_urdf) {
  enum class Kind { planar, one_axis, urdf };
  const Section root = document.root(), s = root.section("robot"), drive = root.section("drive");
  root.leave_to_others("device");  // how it is reached is the session's affair
  const Kind kind =
      s.required_choice<Kind>("kind", {{"planar", Kind::planar}, {"one_axis", Kind::one_axis}, {"urdf", Kind::urdf}});
  RobotDescription description;
  DriveTerms terms = read_terms(drive);
  const auto bodies = [&]() -> Result<Bodies> {
    if (kind == Kind::planar) return read_planar(s, terms);
    if (kind == Kind::one_axis) return read_one_axis(s);
    const std::string name = s.required_text("file");
    if (name.empty()) return tl::unexpected(s.error("file", "the URDF file is missing", "write file = \"robot.urdf\""));
    auto urdf = MBK_TRY(find_urdf(name));
    auto read = read_urdf(s, urdf);
    description.urdf = std::move(urdf.text);
    return read;
  }();
  if (!bodies) return tl::unexpected(bodies.error());
  if (kind != Kind::planar) read_velocities(drive, *bodies->mechanism, terms);
  DriveValues drives(terms, bodies->mechanism->joints());
  bodies->add_drives(drives);
  read_values(drive, *bodies->mechanism, bodies->drives_elsewhere, drives);
  const double delay = drive.number("motor_delay_ms", 0.0, config::at_least(0));
  MBK_TRY(document.finish());

  description.impossible = bodies->impossible;
  robot::DynamicModel& model = description.model;
  model.mechanism = bodies->mechanism;
  model.drive = terms;
  model.delay = delay;
  model.parameters.resize(bodies->phi.size() + drives.values.size());
  model.parameters << bodies->phi, drives.values;
  std::vector<bool> stated = bodies->stated;
  stated.insert(stated.end(), drives.stated.begin(), drives.stated.end());
  const std::vector<robot::Coefficient> coefficients = model.coefficients();
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    if (!stated[k]) description.unstated.push_back(coefficients[k].name);
  }
  return description;
}

Result<RobotDescription> parsed(std::string_view toml, std::string_view where, const FindUrdf& find_urdf) {
  const auto document = MBK_TRY(config::Document::parse(toml, where));
  auto description = described(document, find_urdf);
  if (!description) return tl::unexpected(description.error());
  description->toml = toml;
  description->source = where;
  return description;
}

}  // namespace

Result<RobotDescription> read_robot_description(const std::filesystem::path& file) {
  if (file.extension() == ".urdf") {
    return parsed("[robot]\nkind = \"urdf\"\nfile = \"robot.urdf\"\n", file.string(),
                  [&](const std::string& /*name*/) { return urdf_of(file); });
  }
  const auto toml = MBK_TRY(text_of(file));
  return parsed(toml, file.string(), [&](const std::string& name) { return urdf_of(file.parent_path() / name); });
}

Result<RobotDescription> parse_robot_description(std::string_view toml, std::string_view urdf, std::string_view where) {
  return parsed(toml, where, [&](const std::string& name) -> Result<Urdf> {
    return Urdf{std::string(urdf), fmt::format("{}, {}", where, name)};
  });
}

RobotDescription thesis_robot() {
  return parse_robot_description("[robot]\nkind = \"planar\"\n", "", "the robot of Dyck 2013, table A.1").value();
}

}  // namespace mbk::robot_file
