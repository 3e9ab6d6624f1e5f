#include "mbk/measure/explore/response_model.h"

#include <algorithm>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::explore {
namespace {

/// Of a limb that is M, B and K to be called something else. Far below the few per cent at which that is meant to
/// happen: directions that the motion hardly excites see a noise that no short autoregression knows exactly.
constexpr double kChanceOfMisfit = 1e-5;

Vector deviations(const Matrix& covariance) {
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace

ResponseModel fit_response_model(const Matrix& D, const LaggedFit& fit, Index n) {
  ResponseModel model;
  const Index r = D.rows();
  for (Matrix* of : {&model.M, &model.B, &model.K, &model.M_half_width, &model.B_half_width, &model.K_half_width}) {
    *of = Matrix::Constant(n, n, kNaN);
  }
  if (r < 3 * n) return model;
  const Vector scale = D.colwise().norm().cwiseInverse();
  const Matrix scaled = D * scale.asDiagonal();
  if (!scaled.allFinite() || numeric::PivotedQr(scaled, 1e-9).rank() < 3 * n) return model;
  model.identifiable = true;
  model.numerator = static_cast<double>(r - 3 * n);
  model.denominator = static_cast<double>(fit.residual.rows() - fit.coefficients.rows());
  for (Index i = 0; i < n; ++i) {
    const Matrix V = fit.covariance[static_cast<std::size_t>(i)].topLeftCorner(r, r);
    const Vector own = deviations(V).cwiseInverse();
    const numeric::PivotedCholesky weights(own.asDiagonal() * V * own.asDiagonal());
    const Matrix Dw = own.asDiagonal() * scaled;
    const Vector aw = own.cwiseProduct(fit.coefficients.col(i).head(r));
    const Matrix C = numeric::inverse(Dw.transpose() * weights.solve(Dw));
    const Vector theta = C * (Dw.transpose() * weights.solve(aw));
    const Vector rest = aw - Dw * theta;
    const Vector value = scale.cwiseProduct(theta);
    const Vector half = numeric::kNormal95 * scale.cwiseProduct(deviations(C));
    model.M.row(i) = value.head(n);
    model.B.row(i) = value.segment(n, n);
    model.K.row(i) = value.tail(n);
    model.M_half_width.row(i) = half.head(n);
    model.B_half_width.row(i) = half.segment(n, n);
    model.K_half_width.row(i) = half.tail(n);
    if (r == 3 * n) continue;
    const double statistic = rest.dot(weights.solve(rest)) / model.numerator;
    model.statistic = std::max(model.statistic, statistic);
    model.p_value =
        std::min(model.p_value,
                 static_cast<double>(n) * numeric::f_probability_above(statistic, model.numerator, model.denominator));
  }
  model.enough = model.p_value >= kChanceOfMisfit;
  const auto narrow = [](const Matrix& value, const Matrix& half) {
    return (half.diagonal().array() < value.diagonal().array().abs()).all();
  };
  model.M_identifiable = narrow(model.M, model.M_half_width);
  model.B_identifiable = narrow(model.B, model.B_half_width);
  model.K_identifiable = narrow(model.K, model.K_half_width);
  return model;
}

}  // namespace mbk::explore
