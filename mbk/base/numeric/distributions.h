#pragma once

namespace mbk::numeric {

/// Distributions of Boost.Math, for degrees of freedom that need not be whole. None throws: what is not defined is NaN.

/// t with P(T ≤ t) = p. @param degrees_of_freedom > 0, or ∞
[[nodiscard]] double student_quantile(double p, double degrees_of_freedom);

/// P(|T| ≥ |t|). @param degrees_of_freedom > 0, or ∞
[[nodiscard]] double student_two_sided(double t, double degrees_of_freedom);

/// x with P(F ≤ x) = p.
[[nodiscard]] double f_quantile(double p, double numerator, double denominator);
/// P(F > x); 1 where x is not above 0.
[[nodiscard]] double f_probability_above(double x, double numerator, double denominator);

/// x with P(χ² ≤ x) = p, and P(χ² > x).
[[nodiscard]] double chi_square_quantile(double p, double degrees_of_freedom);
[[nodiscard]] double chi_square_above(double x, double degrees_of_freedom);

/// P(T ≤ t) and P(T > t) of the noncentral t, (Z + δ)/√(χ²_ν/ν), each without cancellation.
[[nodiscard]] double noncentral_t_below(double t, double degrees_of_freedom, double noncentrality);
[[nodiscard]] double noncentral_t_above(double t, double degrees_of_freedom, double noncentrality);

/// t with P(T ≤ t) = p of the noncentral t.
[[nodiscard]] double noncentral_t_quantile(double p, double degrees_of_freedom, double noncentrality);

/// δ with P(T ≤ t) = p, which falls as δ rises.
/// @param t finite
[[nodiscard]] double noncentrality_of(double t, double degrees_of_freedom, double p);

}  // namespace mbk::numeric
