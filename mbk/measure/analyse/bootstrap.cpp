#include "mbk/measure/analyse/bootstrap.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "mbk/base/numeric/block_bootstrap.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/passivity_index.h"

namespace mbk::analyse {
namespace {

using impedance::matrix_of;
using impedance::Model;

/// A number of a model, with its derivative by the stacked model.
struct Quantity {
  std::string name, unit;
  std::function<double(const Model&)> value;
  Eigen::RowVectorXd gradient;
  bool positive = false;  ///< its delta-method interval is one of its logarithm
};

Eigen::RowVectorXd at(Index size, Index place, const Eigen::RowVectorXd& values) {
  Eigen::RowVectorXd gradient = Eigen::RowVectorXd::Zero(size);
  gradient.segment(place, values.size()) = values;
  return gradient;
}

/// The angle of an ellipse's major axis nearest to `about`.
double orientation_near(const Matrix& Z, double about) {
  const double angle = impedance::ellipse(Z).orientation;
  return angle - std::numbers::pi * std::round((angle - about) / std::numbers::pi);
}

void add_ellipses(const Identification& id, std::vector<Quantity>& all) {
  const auto size = static_cast<Index>(id.parameters.size());
  const Units units = units_of(id.motion);
  const std::array<const char*, 3> unit = {units.inertia, units.damping, units.stiffness};
  for (int k = 0; k < 3; ++k) {
    const auto which = static_cast<std::size_t>(k);
    const std::string name = kMatrixNames[which];
    const impedance::EllipseGradient gradient = impedance::ellipse_gradient(matrix_of(id.model, k));
    const Index place = 4 * k;
    const double about = impedance::ellipse(matrix_of(id.model, k)).orientation;
    all.push_back({name + " largest eigenvalue", unit[which],
                   [k](const Model& m) { return impedance::ellipse(matrix_of(m, k)).lambda_max; },
                   at(size, place, gradient.lambda_max)});
    all.push_back({name + " smallest eigenvalue", unit[which],
                   [k](const Model& m) { return impedance::ellipse(matrix_of(m, k)).lambda_min; },
                   at(size, place, gradient.lambda_min)});
    all.push_back({name + " area", fmt::format("({})²", unit[which]),
                   [k](const Model& m) { return impedance::ellipse(matrix_of(m, k)).area; },
                   at(size, place, gradient.area), true});
    all.push_back({name + " shape", "", [k](const Model& m) { return impedance::ellipse(matrix_of(m, k)).shape; },
                   at(size, place, gradient.shape), true});
    all.push_back({name + " orientation", "rad",
                   [k, about](const Model& m) { return orientation_near(matrix_of(m, k), about); },
                   at(size, place, gradient.orientation)});
    if (k == 1) continue;
    all.push_back({name + " antisymmetry", unit[which],
                   [k](const Model& m) { return impedance::antisymmetric_part(matrix_of(m, k)); },
                   at(size, place, Eigen::RowVector4d(0.0, 0.5, -0.5, 0.0))});
  }
}

std::vector<Quantity> quantities(const Identification& id) {
  std::vector<Quantity> all;
  const auto size = static_cast<Index>(id.parameters.size());
  const Index n = id.axes;
  const Units units = units_of(id.motion);
  for (Index i = 0; i < size; ++i) {
    const Index matrix = i / (n * n);
    const char* unit = matrix == 0   ? units.inertia
                       : matrix == 1 ? units.damping
                       : matrix == 2 ? units.stiffness
                                     : units.position;
    all.push_back({id.parameters[static_cast<std::size_t>(i)], unit,
                   [i](const Model& m) { return impedance::stacked(m)[i]; }, at(size, i, Eigen::RowVectorXd::Ones(1))});
  }
  if (n == 2) add_ellipses(id, all);
  if (const auto excess = impedance::excess_of_passivity(id.model)) {
    all.push_back({"excess of passivity", units.damping,
                   [](const Model& m) { return impedance::smallest_eigenvalue(m, 1).value; }, excess->gradient});
  }
  return all;
}

}  // namespace

Result<BootstrapFindings> bootstrap_findings(const Identification& id) {
  if (!id.replicates) return bad_usage("the model was identified without bootstrap", "add --bootstrap 1000");
  const Replicates& replicates = *id.replicates;
  const Index count = replicates.models.cols();
  BootstrapFindings result{static_cast<int>(count), replicates.block_s, replicates.blocks, replicates.seed, {}};
  const double widening = numeric::newey_west_widening(1.0 / std::max(1.0, replicates.blocks));
  std::vector<Model> models;
  for (Index k = 0; k < count; ++k) models.push_back(impedance::unstacked(replicates.models.col(k), id.axes));
  for (const Quantity& quantity : quantities(id)) {
    const double value = quantity.value(id.model);
    Vector drawn(count);
    for (Index k = 0; k < count; ++k) drawn[k] = quantity.value(models[static_cast<std::size_t>(k)]);
    auto [low, high] = numeric::bias_corrected_interval(value, drawn, 0.95);
    low = value - widening * (value - low);
    high = value + widening * (high - value);
    const double error = impedance::standard_error({value, quantity.gradient}, id.covariance);
    result.findings.push_back(
        {quantity.name,
         quantity.unit,
         value,
         {low, high},
         quantity.positive ? numeric::positive_interval95(value, error) : numeric::interval95(value, error)});
  }
  return result;
}

}  // namespace mbk::analyse
