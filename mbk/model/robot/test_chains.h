#pragma once

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mbk/model/robot/mechanism.h"

namespace mbk::robot {

/// A serial robot of arbitrary frames and bodies that obey the laws of bodies, the same for the same seed.
class RandomChain {
 public:
  struct Link {
    char kind = 'R';                      // R turns, P slides, C turns without end
    Eigen::Vector3d place, turn;          // of the joint from the link before: xyz [m], roll pitch yaw [rad]
    Eigen::Vector3d axis;                 // of any length
    double mass = 1.0;                    // [kg]
    Eigen::Vector3d centre, centre_turn;  // of mass [m], and the axes of `inertia` [rad]
    Eigen::Vector3d inertia;              // principal moments about the centre [kg·m²]
  };

  RandomChain(const std::string& kinds, unsigned seed) : random_(seed) {
    for (const char kind : kinds) {
      Link link;
      link.kind = kind;
      link.place = uniform3(0.4);
      link.turn = uniform3(1.5);
      link.axis = uniform3(1.0) + Eigen::Vector3d(0.0, 0.0, 1.5);
      link.mass = 2.0 + uniform(1.5);
      link.centre = uniform3(0.15);
      link.centre_turn = uniform3(3.0);
      const Eigen::Vector3d extent = Eigen::Vector3d(0.12, 0.15, 0.2) + uniform3(0.08);  // of a box
      const Eigen::Vector3d squares = extent.cwiseAbs2();
      link.inertia = link.mass / 12.0 * (Eigen::Vector3d::Constant(squares.sum()) - squares);
      links.push_back(link);
    }
  }

  /// In [−reach, reach).
  double uniform(double reach) { return reach * (static_cast<double>(random_() >> 11u) * 0x1p-52 - 1.0); }
  Eigen::Vector3d uniform3(double reach) {
    const double x = uniform(reach), y = uniform(reach), z = uniform(reach);
    return {x, y, z};
  }
  JointVector uniform_joints(double reach) {
    JointVector q(joints());
    for (double& one : q) one = uniform(reach);
    return q;
  }
  [[nodiscard]] Index joints() const { return static_cast<Index>(links.size()); }

  /// Link k is named "link_k", its joint "joint_k", from 1; the root is "base".
  [[nodiscard]] std::string urdf() const {
    const auto origin = [](const Eigen::Vector3d& place, const Eigen::Vector3d& turn) {
      return fmt::format(R"(<origin xyz="{:.17g} {:.17g} {:.17g}" rpy="{:.17g} {:.17g} {:.17g}"/>)", place[0], place[1],
                         place[2], turn[0], turn[1], turn[2]);
    };
    std::string text = R"(<robot name="random"><link name="base"/>)", before = "base";
    for (std::size_t k = 0; k < links.size(); ++k) {
      const Link& link = links[k];
      const std::string name = fmt::format("link_{}", k + 1);
      text += fmt::format(
          R"(<link name="{}"><inertial>{}<mass value="{:.17g}"/>)"
          R"(<inertia ixx="{:.17g}" iyy="{:.17g}" izz="{:.17g}" ixy="0" ixz="0" iyz="0"/></inertial></link>)",
          name, origin(link.centre, link.centre_turn), link.mass, link.inertia[0], link.inertia[1], link.inertia[2]);
      text += fmt::format(R"(<joint name="joint_{}" type="{}">{}<axis xyz="{:.17g} {:.17g} {:.17g}"/>)"
                          R"(<limit lower="-3" upper="3" effort="1" velocity="1"/>)"
                          R"(<parent link="{}"/><child link="{}"/></joint>)",
                          k + 1, type(link.kind), origin(link.place, link.turn), link.axis[0], link.axis[1],
                          link.axis[2], before, name);
      before = name;
    }
    return text + "</robot>";
  }

  std::vector<Link> links;

 private:
  std::mt19937_64 random_;

  static const char* type(char kind) { return kind == 'R' ? "revolute" : kind == 'P' ? "prismatic" : "continuous"; }
};

}  // namespace mbk::robot
