#include "mbk/study/reliability/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::reliability {
namespace {

Result<void> check_samples(const Vector& first, const Vector& second, Pairing pairing) {
  for (const auto& [name, sample] : {std::pair("first", &first), std::pair("second", &second)}) {
    if (const Index i = first_non_finite(*sample); i >= 0) {
      return bad_data(fmt::format("value {} of the {} sample is not a finite number", i + 1, name), "omit it");
    }
  }
  if (pairing == Pairing::paired && first.size() != second.size()) {
    return bad_data(fmt::format("{} first and {} second values do not form pairs", first.size(), second.size()),
                    "give both of each person");
  }
  return {};
}

/// t and how often it is that of chance: difference, standard error and degrees of freedom.
struct StudentT {
  double difference = 0, standard_error = 0, degrees = 0;

  [[nodiscard]] double t() const {
    if (standard_error > 0.0) return difference / standard_error;
    return difference == 0.0 ? 0.0 : std::copysign(std::numeric_limits<double>::infinity(), difference);
  }
};

StudentT welch(const Vector& first, const Vector& second) {
  const auto n1 = static_cast<double>(first.size()), n2 = static_cast<double>(second.size());
  const double v1 = numeric::variance(first) / n1, v2 = numeric::variance(second) / n2, v = v1 + v2;
  return {second.mean() - first.mean(), std::sqrt(v), v * v / (v1 * v1 / (n1 - 1.0) + v2 * v2 / (n2 - 1.0))};
}

StudentT of_differences(const Vector& differences) {
  const auto n = static_cast<double>(differences.size());
  return {differences.mean(), std::sqrt(numeric::variance(differences) / n), n - 1.0};
}

/// Γ(ν/2)/(√(ν/2) Γ((ν−1)/2)); 0 for ν = 1, where d has no mean.
double unbiasing(double degrees) {
  if (degrees <= 1.0) return 0.0;
  return std::exp(std::lgamma(0.5 * degrees) - std::lgamma(0.5 * (degrees - 1.0))) / std::sqrt(0.5 * degrees);
}

EffectSize effect_of(double d, double degrees, double effective_count) {
  const double root = std::sqrt(effective_count), t = d * root;
  return {unbiasing(degrees) * d,
          d,
          {numeric::noncentrality_of(t, degrees, 1.0 - kTail95) / root,
           numeric::noncentrality_of(t, degrees, kTail95) / root}};
}

/// Counts arrangements whose |t| is as large as the one that was measured, but for rounding.
class Counter {
 public:
  explicit Counter(double measured) : limit_(std::abs(measured) * (1.0 - 1e-10)) {}
  void add(double t) {
    ++all_;
    if (std::abs(t) >= limit_) ++as_large_;
  }
  [[nodiscard]] int all() const { return all_; }
  [[nodiscard]] int as_large() const { return as_large_; }

 private:
  double limit_;
  int all_ = 0, as_large_ = 0;
};

/// n over k, or `most` + 1 where it is more.
double arrangements_of(Index n, Index k, double most) {
  double count = 1.0;
  for (Index i = 1; i <= std::min(k, n - k) && count <= most; ++i) {
    count = count * static_cast<double>(n - i + 1) / static_cast<double>(i);
  }
  return std::round(std::min(count, most + 1.0));
}

double t_of_split(const Vector& all, const std::vector<bool>& is_first, Index first_count) {
  Vector first(first_count), second(all.size() - first_count);
  Index a = 0, b = 0;
  for (Index i = 0; i < all.size(); ++i) {
    (is_first[static_cast<std::size_t>(i)] ? first[a++] : second[b++]) = all[i];
  }
  return welch(first, second).t();
}

void every_split(const Vector& all, Index first_count, Counter& counter) {
  std::vector<bool> is_first(static_cast<std::size_t>(all.size()), false);
  std::fill_n(is_first.begin(), first_count, true);
  do {
    counter.add(t_of_split(all, is_first, first_count));
  } while (std::prev_permutation(is_first.begin(), is_first.end()));
}

void drawn_splits(const Vector& all, Index first_count, const PermutationOptions& options, Counter& counter) {
  numeric::Random random(options.seed);
  Vector shuffled = all;
  for (int draw = 0; draw < options.draws; ++draw) {
    for (Index i = 0; i < first_count; ++i) {
      const auto other = i + static_cast<Index>(random.below(static_cast<std::uint64_t>(all.size() - i)));
      std::swap(shuffled[i], shuffled[other]);
    }
    counter.add(welch(shuffled.head(first_count), shuffled.tail(all.size() - first_count)).t());
  }
}

void every_sign(const Vector& differences, Counter& counter) {
  Vector turned = differences;
  for (std::uint64_t signs = 0; signs < std::uint64_t{1} << static_cast<unsigned>(differences.size()); ++signs) {
    for (Index i = 0; i < differences.size(); ++i) {
      turned[i] = (signs >> static_cast<unsigned>(i) & 1U) != 0 ? -differences[i] : differences[i];
    }
    counter.add(of_differences(turned).t());
  }
}

void drawn_signs(const Vector& differences, const PermutationOptions& options, Counter& counter) {
  numeric::Random random(options.seed);
  Vector turned = differences;
  for (int draw = 0; draw < options.draws; ++draw) {
    for (Index i = 0; i < differences.size(); ++i) turned[i] = random.below(2) == 0 ? differences[i] : -differences[i];
    counter.add(of_differences(turned).t());
  }
}

Result<std::vector<std::size_t>> rising(const Vector& p) {
  for (Index i = 0; i < p.size(); ++i) {
    if (!(p[i] >= 0.0 && p[i] <= 1.0)) {
      return bad_data(fmt::format("p-value {} is {:g}", i + 1, p[i]), "give values of 0 to 1");
    }
  }
  std::vector<std::size_t> order(static_cast<std::size_t>(p.size()));
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return p[static_cast<Index>(i)]; });
  return order;
}

}  // namespace

Result<Difference> difference(const Vector& first, const Vector& second, Pairing pairing) {
  MBK_TRY(check_samples(first, second, pairing));
  Difference result;
  result.pairing = pairing;
  result.first_count = static_cast<int>(first.size());
  result.second_count = static_cast<int>(second.size());
  if (first.size() < 2 || second.size() < 2) {
    result.support = Support::too_few_people;
    result.value = first.size() > 0 && second.size() > 0 ? second.mean() - first.mean() : kNaN;
    result.p = result.standard_error = result.effect.g = result.effect.d = kNaN;
    return result;
  }
  const bool paired = pairing == Pairing::paired;
  const StudentT student = paired ? of_differences(second - first) : welch(first, second);
  result.value = student.difference;
  result.standard_error = student.standard_error;
  result.degrees_of_freedom = student.degrees;
  if (!(student.standard_error > 0.0)) {
    result.support = Support::no_variation;
    result.interval95 = {result.value, result.value};
    result.p = result.effect.g = result.effect.d = kNaN;
    return result;
  }
  const double reach = numeric::student_quantile(1.0 - kTail95, student.degrees) * student.standard_error;
  result.interval95 = {result.value - reach, result.value + reach};
  result.p = numeric::student_two_sided(student.t(), student.degrees);
  const auto n1 = static_cast<double>(first.size()), n2 = static_cast<double>(second.size());
  if (paired) {
    result.effect = effect_of(student.t() / std::sqrt(n1), n1 - 1.0, n1);
  } else {
    const double degrees = n1 + n2 - 2.0;
    const double pooled =
        std::sqrt(((n1 - 1.0) * numeric::variance(first) + (n2 - 1.0) * numeric::variance(second)) / degrees);
    result.effect = effect_of(result.value / pooled, degrees, n1 * n2 / (n1 + n2));
  }
  return result;
}

double difference_p(const Vector& first, const Vector& second, Pairing pairing) {
  if (first.size() < 2 || second.size() < 2) return kNaN;
  const StudentT student = pairing == Pairing::paired ? of_differences(second - first) : welch(first, second);
  return student.standard_error > 0.0 ? numeric::student_two_sided(student.t(), student.degrees) : kNaN;
}

Result<Permutation> permutation_test(const Vector& first, const Vector& second, Pairing pairing,
                                     const PermutationOptions& options) {
  if (options.draws < 1 || options.max_exact < 1) {
    return bad_usage(fmt::format("{} draws or {} arrangements are too few", options.draws, options.max_exact),
                     "request at least 1");
  }
  MBK_TRY(check_samples(first, second, pairing));
  Permutation result;
  result.p = kNaN;
  if (first.size() < 2 || second.size() < 2) {
    result.support = Support::too_few_people;
    return result;
  }
  const bool paired = pairing == Pairing::paired;
  Vector all(first.size() + second.size());
  all << first, second;
  const Vector differences = paired ? Vector(second - first) : Vector();
  if (paired ? differences.isZero(0.0) : all.maxCoeff() == all.minCoeff()) {
    result.support = Support::no_variation;
    result.p = 1.0;
    return result;
  }
  const double most = options.max_exact;
  const double arrangements = paired ? std::min(std::exp2(static_cast<double>(differences.size())), most + 1.0)
                                     : arrangements_of(all.size(), first.size(), most);
  result.exact = arrangements <= most;
  Counter counter(paired ? of_differences(differences).t() : welch(first, second).t());
  if (paired) {
    result.exact ? every_sign(differences, counter) : drawn_signs(differences, options, counter);
  } else {
    result.exact ? every_split(all, first.size(), counter) : drawn_splits(all, first.size(), options, counter);
  }
  result.arrangements = counter.all();
  // Each arrangement of signs, and each of two equal groups, has another one with −t.
  const double alike = paired || first.size() == second.size() ? 2.0 : 1.0;
  const double drawn = result.exact ? 0.0 : 1.0;
  result.p = (counter.as_large() + drawn) / (counter.all() + drawn);
  result.smallest_p = result.exact ? alike / counter.all() : 1.0 / (counter.all() + 1.0);
  constexpr double kLevel = 0.05;
  if (result.smallest_p > kLevel) result.support = Support::too_few_people;
  return result;
}

Result<Vector> holm(const Vector& p) {
  const auto order = MBK_TRY(rising(p));
  Vector adjusted(p.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto k = static_cast<Index>(order[i]);
    largest = std::max(largest, std::min(1.0, static_cast<double>(order.size() - i) * p[k]));
    adjusted[k] = largest;
  }
  return adjusted;
}

Result<Vector> benjamini_hochberg(const Vector& p) {
  const auto order = MBK_TRY(rising(p));
  Vector adjusted(p.size());
  double smallest = 1.0;
  for (std::size_t i = order.size(); i-- > 0;) {
    const auto k = static_cast<Index>(order[i]);
    smallest = std::min(smallest, static_cast<double>(order.size()) * p[k] / static_cast<double>(i + 1));
    adjusted[k] = smallest;
  }
  return adjusted;
}

}  // namespace mbk::reliability
