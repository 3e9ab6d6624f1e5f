#include <console_bridge/console.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <kdl/rigidbodyinertia.hpp>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "mbk/model/robot/chain_parts.h"

namespace mbk::robot {
namespace {

using Model = urdf::ModelInterfaceSharedPtr;
using Link = urdf::LinkConstSharedPtr;
using JointOfTree = urdf::JointConstSharedPtr;

/// While it exists, it captures the output of the URDF parser. The parser has one global output handler, so
/// one reads at a time.
class Overheard : public console_bridge::OutputHandler {
 public:
  Overheard() { console_bridge::useOutputHandler(this); }
  ~Overheard() override { console_bridge::restorePreviousOutputHandler(); }
  Overheard(const Overheard&) = delete;
  Overheard(Overheard&&) = delete;
  Overheard& operator=(const Overheard&) = delete;
  Overheard& operator=(Overheard&&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/, int /*line*/) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first_.empty()) first_ = text;
  }
  [[nodiscard]] const std::string& first() const { return first_; }

 private:
  std::lock_guard<std::mutex> alone_{mutex()};
  std::string first_;

  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
};

/// Maximum nesting depth of elements: the parser recurses for each level.
int depth(std::string_view xml) {
  int now = 0, most = 0;
  for (std::size_t i = 0; i + 1 < xml.size(); ++i) {
    if (xml[i] == '<' && xml[i + 1] == '/') --now;
    if (xml[i] == '<' && xml[i + 1] != '/' && xml[i + 1] != '!' && xml[i + 1] != '?') most = std::max(most, ++now);
    if (xml[i] == '/' && xml[i + 1] == '>') --now;
  }
  return most;
}

/// Attributes of the element that has most, at least: the parser looks through all before it for each.
int max_attributes(std::string_view xml) {
  int most = 0;
  for (std::size_t at = xml.find('<'); at != std::string_view::npos; at = xml.find('<', at + 1)) {
    if (xml.substr(at).starts_with("<!--")) {
      at = std::min(xml.find("-->", at), xml.size() - 1);
      continue;
    }
    int count = 0;
    char quote = 0;
    for (; at + 1 < xml.size() && (quote != 0 || xml[at] != '>'); ++at) {
      const char c = xml[at];
      if (quote == 0 && (c == '"' || c == '\'')) {
        quote = c;
      } else if (c == quote) {
        quote = 0;
      } else if (quote == 0 && c == '=') {
        ++count;
      }
    }
    most = std::max(most, count);
  }
  return most;
}

KDL::Frame frame(const urdf::Pose& pose) {
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
  pose.rotation.getQuaternion(x, y, z, w);
  return {KDL::Rotation::Quaternion(x, y, z, w), {pose.position.x, pose.position.y, pose.position.z}};
}

KDL::Vector vector(const Eigen::Vector3d& v) {
  return {v[0], v[1], v[2]};
}

bool finite(const KDL::Frame& frame) {
  return std::isfinite(frame.p.Norm()) && std::isfinite(frame.M.UnitX().Norm() + frame.M.UnitY().Norm());
}

/// Every link has one parent and hangs on the root, so that walks along the tree end.
Result<void> check_tree(const Model& model) {
  std::map<std::string, std::string> parent_joint;
  for (const auto& [name, joint] : model->joints_) {
    const auto [first, is_first] = parent_joint.emplace(joint->child_link_name, name);
    if (!is_first) {
      return bad_data(fmt::format("link '{}' is the child of two joints, '{}' and '{}'", joint->child_link_name,
                                  first->second, name),
                      "give each link one parent: a serial robot is a tree");
    }
  }
  std::size_t reached = 0;
  std::vector<Link> open = {model->getRoot()};
  while (!open.empty()) {
    const Link link = open.back();
    open.pop_back();
    ++reached;
    for (const auto& child : link->child_links) open.push_back(child);
  }
  if (reached == model->links_.size()) return {};
  return bad_data(fmt::format("{} of {} links are not connected to the root link '{}'", model->links_.size() - reached,
                              model->links_.size(), model->getRoot()->name),
                  "connect them: a serial robot is one tree");
}

/// The parser hands what it complains of to printf as a format, so that "%n" in a number would write into memory: each
/// '%' becomes '％'.
std::string without_formats(std::string_view text) {
  std::string safe;
  for (const char c : text) safe += c == '%' ? std::string("％") : std::string(1, c);
  return safe;
}

/// Links that hang on each other in a loop would keep each other alive.
void take_apart(const urdf::ModelInterface& model) {
  for (const auto& [name, link] : model.links_) link->clear();
}

Result<Model> parse(std::string_view urdf) {
  constexpr int kDeepest = 1000;        // a URDF is 4 levels deep
  constexpr int kMaxAttributes = 1000;  // its elements have up to six
  constexpr const char* kRemedy = "check it, for example with 'check_urdf FILE'";
  if (depth(urdf) > kDeepest) return bad_data("the file is not a URDF: elements are nested too deeply", kRemedy);
  if (max_attributes(urdf) > kMaxAttributes) {
    return bad_data(fmt::format("the file is not a URDF: an element has more than {} attributes", kMaxAttributes),
                    kRemedy);
  }
  if (urdf.find("</robot") == std::string_view::npos)
    return bad_data("the file is not a URDF: </robot> is missing", kRemedy);
  const Overheard overheard;
  Model model;
  try {
    model = urdf::parseURDF(without_formats(urdf));
  } catch (const std::exception& problem) {
    return bad_data(fmt::format("no URDF: {}", problem.what()), kRemedy);
  }
  const auto refused = [&](const Error& error) {
    if (model) take_apart(*model);
    return tl::unexpected(error);
  };
  // The parser also gives robots with parts that it could not read.
  if (!overheard.first().empty()) return refused(bad_data("no URDF: " + overheard.first(), kRemedy).value());
  if (!model || !model->getRoot()) return refused(bad_data("no URDF", kRemedy).value());
  if (auto ok = check_tree(model); !ok) return refused(ok.error());
  return model;
}

std::string names(const std::vector<std::string>& all) {
  return fmt::format("'{}'", fmt::join(all, "', '"));
}

Result<Link> find_link(const Model& model, const std::string& name, const char* which) {
  if (const Link link = model->getLink(without_formats(name))) return link;
  std::vector<std::string> known;
  for (const auto& [one, link] : model->links_) known.push_back(one);
  return bad_usage(fmt::format("the URDF has no link '{}' for the {}", name, which), "use one of " + names(known));
}

Result<Link> only_leaf(const Model& model, const Link& base) {
  std::vector<std::string> leaves;
  std::vector<Link> open = {base};
  while (!open.empty()) {
    const Link link = open.back();
    open.pop_back();
    if (link->child_links.empty()) leaves.push_back(link->name);
    for (const auto& child : link->child_links) open.push_back(child);
  }
  if (leaves.size() == 1) return Link(model->getLink(leaves.front()));
  std::sort(leaves.begin(), leaves.end());
  return bad_data(fmt::format("the robot ends in several links: {}", names(leaves)), "select the hand with tip_link");
}

/// The joints from base to tip, in this order.
Result<std::vector<JointOfTree>> way(const Link& base, const Link& tip) {
  std::vector<JointOfTree> joints;
  for (Link link = tip; link != base; link = link->getParent()) {
    if (!link->parent_joint) {
      return bad_usage(fmt::format("link '{}' is not a descendant of link '{}'", tip->name, base->name),
                       "choose base_link and tip_link along one arm");
    }
    joints.emplace_back(link->parent_joint);
  }
  std::reverse(joints.begin(), joints.end());
  return joints;
}

/// The links that are one body: with `link`, all beyond it but for what `beyond` moves. Frame: that of the body.
struct Gathered {
  KDL::RigidBodyInertia inertia;
  bool stated = false;  ///< some link of it has an <inertial>
  std::vector<std::string> impossible;
};

/// Whether some distribution of mass has this inertia about its centre: Σ = ½ tr(I) 1 − I = ∫ r rᵀ dm has no negative
/// eigenvalue, by which each principal moment is at most the sum of the other two. CAD programs round.
bool can_exist(const urdf::Inertial& one) {
  constexpr double kRounded = 1e-3;  // of the largest
  const double sum = one.ixx + one.iyy + one.izz,
               largest = std::max({std::abs(one.ixx), std::abs(one.iyy), std::abs(one.izz)});
  const double half = 0.5 * sum + kRounded * largest;
  const double a = half - one.ixx, b = half - one.iyy, c = half - one.izz;
  if (a == 0.0 && b == 0.0 && c == 0.0) return one.ixy == 0.0 && one.ixz == 0.0 && one.iyz == 0.0;
  const double det = a * (b * c - one.iyz * one.iyz) + one.ixy * (-one.ixy * c - one.iyz * one.ixz) -
                     one.ixz * (one.ixy * one.iyz + b * one.ixz);
  return a > 0.0 && a * b > one.ixy * one.ixy && det > 0.0;
}

Result<void> gather(const Link& link, const KDL::Frame& from_body, const std::string& beyond, Gathered& body) {
  if (link->inertial) {
    const urdf::Inertial& one = *link->inertial;
    const KDL::RotationalInertia about_centre(one.ixx, one.iyy, one.izz, one.ixy, one.ixz, one.iyz);
    const KDL::Frame centre = from_body * frame(one.origin);
    const double sum = one.mass + one.ixx + one.iyy + one.izz + one.ixy + one.ixz + one.iyz;
    if (!std::isfinite(sum) || !finite(centre)) {
      return bad_data(fmt::format("<inertial> of link '{}' contains a number that is not finite", link->name),
                      "correct it");
    }
    if (one.mass < 0.0) {
      return bad_data(fmt::format("link '{}' has a mass of {:g} kg", link->name, one.mass),
                      "correct it, or write 0 if it will be identified");
    }
    if (!can_exist(one)) {
      body.impossible.push_back(
          fmt::format("the inertia of link '{}' is physically impossible (ixx {:.4g}, iyy {:.4g}, izz {:.4g} kg·m²)",
                      link->name, one.ixx, one.iyy, one.izz));
    }
    body.inertia = body.inertia + centre * KDL::RigidBodyInertia(one.mass, KDL::Vector::Zero(), about_centre);
    body.stated = true;
  }
  for (const auto& joint : link->child_joints) {
    if (joint->name == beyond) continue;
    const auto child = std::find_if(link->child_links.begin(), link->child_links.end(),
                                    [&](const auto& one) { return one->name == joint->child_link_name; });
    if (child == link->child_links.end()) continue;
    const KDL::Frame there = from_body * frame(joint->parent_to_joint_origin_transform);
    MBK_TRY(gather(*child, there, beyond, body));
  }
  return {};
}

Result<void> check_kind(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
    case urdf::Joint::CONTINUOUS:
    case urdf::Joint::PRISMATIC:
      break;
    default:
      return bad_data(fmt::format("joint '{}' is {}", joint.name,
                                  joint.type == urdf::Joint::FLOATING ? "floating"
                                  : joint.type == urdf::Joint::PLANAR ? "planar"
                                                                      : "of an unknown type"),
                      "use only revolute, continuous, prismatic or fixed joints between base and tip");
  }
  if (joint.mimic) {
    return bad_data(fmt::format("joint '{}' mimics joint '{}'", joint.name, joint.mimic->joint_name),
                    "make it fixed, or model the chain without it: mimic joints are not supported");
  }
  return {};
}

/// @param zero, sign  the URDF's coordinate is zero + sign · the recording's
Result<SerialChain::Joint> description(const urdf::Joint& joint, double zero, int sign) {
  SerialChain::Joint d{joint.name, joint.child_link_name, joint.type == urdf::Joint::PRISMATIC};
  if (joint.dynamics) {
    d.damping = joint.dynamics->damping;
    d.friction = joint.dynamics->friction;
    if (!std::isfinite(d.damping + d.friction)) {
      return bad_data(fmt::format("<dynamics> of joint '{}' contains a number that is not finite", joint.name),
                      "correct it");
    }
    if (d.damping < 0.0 || d.friction < 0.0) {
      return bad_data(fmt::format("<dynamics> of joint '{}' is negative: friction would add energy", joint.name),
                      "correct it, or write 0 if it will be identified");
    }
  }
  if (joint.type == urdf::Joint::CONTINUOUS) {
    constexpr double kWithoutEnd = std::numeric_limits<double>::infinity();
    d.range = {-kWithoutEnd, kWithoutEnd};
    return d;
  }
  const double lower = joint.limits ? joint.limits->lower : 0.0, upper = joint.limits ? joint.limits->upper : 0.0;
  if (!(lower < upper) || !std::isfinite(upper - lower)) {
    return bad_data(
        fmt::format("the limits of joint '{}', {:g} … {:g}, leave no range of motion", joint.name, lower, upper),
        "write lower and upper in its <limit>, or make it continuous or fixed");
  }
  const auto [low, high] = std::minmax({sign * (lower - zero), sign * (upper - zero)});
  d.range = {low, high};
  return d;
}

void append_coefficients(const std::string& link, const KDL::RigidBodyInertia& inertia, ChainParts& parts) {
  const KDL::Vector h = inertia.getMass() * inertia.getCOG();
  const KDL::RotationalInertia about_origin = inertia.getRotationalInertia();
  const double* I = about_origin.data;
  const Index first = parts.stated.size();
  parts.stated.conservativeResize(first + kCoefficientsPerBody);
  parts.stated.tail(kCoefficientsPerBody) << inertia.getMass(), h[0], h[1], h[2], I[0], I[1], I[2], I[4], I[5], I[8];
  const auto add = [&](const char* name, const char* unit) {
    parts.coefficients.push_back({fmt::format("{}.{}", link, name), unit});
  };
  add("mass", "kg");
  for (const char* name : {"mass_x", "mass_y", "mass_z"}) add(name, "kg·m");
  for (const char* name : {"inertia_xx", "inertia_xy", "inertia_xz", "inertia_yy", "inertia_yz", "inertia_zz"}) {
    add(name, "kg·m²");
  }
}

Result<void> check_options(const SerialChain::Options& options) {
  if (!options.gravity.allFinite()) return bad_usage("gravity is not finite", "give three numbers in m/s²");
  if (!options.tool.allFinite()) return bad_usage("the tool position is not finite", "give three numbers");
  const std::set<SerialChain::Axis> different(options.hand_axes.begin(), options.hand_axes.end());
  if (different.empty() || different.size() > 3 || different.size() != options.hand_axes.size()) {
    return bad_usage("the measured axes of the hand are not one to three different axes", "choose from x, y and z");
  }
  return {};
}

Result<void> check_readings(const SerialChain::Options& options, std::size_t joints) {
  const auto fits = [&](std::size_t given, const char* what) -> Result<void> {
    if (given == 0 || given == joints) return {};
    return bad_usage(fmt::format("there are {} {} for {} joints", given, what, joints),
                     "give one for each moving joint");
  };
  MBK_TRY(fits(options.zero.size(), "zeros"));
  MBK_TRY(fits(options.sign.size(), "signs"));
  if (!std::all_of(options.zero.begin(), options.zero.end(), [](double zero) { return std::isfinite(zero); })) {
    return bad_usage("the zero of a joint is not finite", "give finite numbers");
  }
  if (!std::all_of(options.sign.begin(), options.sign.end(), [](int sign) { return sign == 1 || sign == -1; })) {
    return bad_usage("the sign of a joint is neither 1 nor −1", "choose 1 or −1");
  }
  return {};
}

}  // namespace

Result<ChainParts> chain_from_urdf(std::string_view urdf, const SerialChain::Options& options) {
  MBK_TRY(check_options(options));
  const auto parsed = MBK_TRY(parse(urdf));
  const Model& model = parsed;
  const auto base =
      MBK_TRY(options.base_link.empty() ? Result<Link>(model->getRoot()) : find_link(model, options.base_link, "base"));
  const auto tip =
      MBK_TRY(options.tip_link.empty() ? only_leaf(model, base) : find_link(model, options.tip_link, "tip"));
  const auto joints = MBK_TRY(way(base, tip));

  std::vector<JointOfTree> moving;
  std::copy_if(joints.begin(), joints.end(), std::back_inserter(moving),
               [](const JointOfTree& joint) { return joint->type != urdf::Joint::FIXED; });
  if (moving.empty() || moving.size() > kMaxJoints) {
    if (moving.empty()) {
      return bad_data(fmt::format("no joint between link '{}' and link '{}' moves", base->name, tip->name),
                      fmt::format("1 to {} moving joints are needed", kMaxJoints));
    }
    return bad_data(fmt::format("{} joints move between link '{}' and link '{}'", moving.size(), base->name, tip->name),
                    fmt::format("1 to {} are supported", kMaxJoints));
  }
  MBK_TRY(check_readings(options, moving.size()));

  ChainParts parts;
  parts.base_link = base->name;
  parts.tip_link = tip->name;
  parts.gravity = vector(options.gravity);
  for (const SerialChain::Axis axis : options.hand_axes) parts.hand_axes.push_back(static_cast<int>(axis));
  for (int axis = 0; axis < 3; ++axis) {
    if (std::ranges::find(parts.hand_axes, axis) == parts.hand_axes.end()) parts.other_axes.push_back(axis);
  }
  KDL::Frame from_body;  // of the link that is reached, from the last body that moves
  for (const JointOfTree& joint : joints) {
    const KDL::Frame origin = from_body * frame(joint->parent_to_joint_origin_transform);
    if (!finite(origin)) {
      return bad_data(fmt::format("<origin> of joint '{}' contains a number that is not finite", joint->name),
                      "correct it");
    }
    from_body = origin;
    if (joint->type == urdf::Joint::FIXED) continue;
    MBK_TRY(check_kind(*joint));
    const std::size_t i = parts.joints.size();
    const double zero = options.zero.empty() ? 0.0 : options.zero[i];
    const int sign = options.sign.empty() ? 1 : options.sign[i];
    auto told = description(*joint, zero, sign);
    if (!told) return tl::unexpected(told.error());
    KDL::Vector axis(joint->axis.x, joint->axis.y, joint->axis.z);
    if (const double length = axis.Norm(); !(length > 0.0) || !std::isfinite(length)) {
      return bad_data(fmt::format("the axis of joint '{}' has zero length", joint->name),
                      "write a direction in its <axis>");
    }
    axis = axis / axis.Norm();
    ChainJoint unturned{origin, axis, told->slides};
    parts.joints.push_back({unturned.pose(zero), static_cast<double>(sign) * axis, told->slides});

    const std::string beyond = i + 1 < moving.size() ? moving[i + 1]->name : std::string();
    Gathered body;
    MBK_TRY(gather(model->getLink(told->link), KDL::Frame(), beyond, body));
    if (!body.stated) {
      return bad_data(fmt::format("link '{}' moves but has no <inertial>", told->link),
                      "add <inertial>; if its values will be identified, any values are accepted, including 0");
    }
    append_coefficients(told->link, body.inertia, parts);
    parts.impossible.insert(parts.impossible.end(), body.impossible.begin(), body.impossible.end());
    parts.descriptions.push_back(*std::move(told));
    from_body = KDL::Frame();
  }
  parts.hand = from_body * vector(options.tool);
  if (!parts.stated.allFinite()) {
    return bad_data("the inertias of the bodies are not finite", "check mass, inertia and origin of each link");
  }
  return parts;
}

}  // namespace mbk::robot
