#include "mbk/measure/identify/prediction_error.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "mbk/base/dsp/autoregression.h"
#include "mbk/base/dsp/difference_equation.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/base/numeric/polynomial_roots.h"
#include "mbk/measure/identify/srivc.h"

namespace mbk::identify {
namespace {

using dsp::difference_equation;

const Vector kOne = Vector::Ones(1);

/// 1, c₁ … c_n.
Vector monic(const Vector& c) {
  Vector whole(c.size() + 1);
  whole << 1.0, c;
  return whole;
}

/// Whether 1 + c₁ q⁻¹ + … has its roots inside the unit circle, by Levinson's recursion backwards (Schur & Cohn).
bool is_stable(Vector c) {
  for (Index n = c.size(); n > 0; --n) {
    const double reflection = c[n - 1];
    if (!(std::abs(reflection) < 1.0)) return false;
    c = ((c.head(n - 1) - reflection * c.head(n - 1).reverse()) / (1.0 - reflection * reflection)).eval();
  }
  return true;
}

Vector from_roots(const Eigen::VectorXcd& roots) {
  return numeric::monic_from_roots(roots).reverse();
}

/// Roots outside the unit circle are reflected into it.
Vector stabilised(const Vector& c) {
  if (!c.allFinite()) return Vector::Zero(c.size());
  if (is_stable(c)) return c;
  constexpr double kInside = 0.9999;
  Eigen::VectorXcd roots = numeric::polynomial_roots(monic(c).reverse());
  for (auto& root : roots) {
    if (std::abs(root) > kInside) root /= std::max(std::norm(root), std::abs(root) / kInside);
  }
  return from_roots(roots);
}

/// Roots near the unit circle are put to a damping ratio from where a search finds another way.
Vector moved_inside(const Vector& f) {
  constexpr double kNear = 0.999, kDamping = 0.1;
  Eigen::VectorXcd roots = numeric::polynomial_roots(monic(f).reverse());
  for (auto& root : roots) {
    if (std::abs(root) > kNear) root *= std::exp(-kDamping * std::abs(std::log(root))) / std::abs(root);
  }
  return from_roots(roots);
}

/// x[t − lag], from rest.
template <class Column>
void put_shifted(const Vector& x, Index lag, double sign, Column&& to) {
  to.head(lag).setZero();
  to.tail(x.size() - lag) = sign * x.head(x.size() - lag);
}

/// The noise model's inverse, C/D.
struct Whitening {
  Vector C, D;
  [[nodiscard]] Vector operator()(const Vector& x) const {
    return C.size() + D.size() == 2 ? x : difference_equation(C, D, x);
  }
};

/// Impulse responses of 1/F from the first samples on, and a constant: what an initial state and an offset can do.
Matrix free_motion(const Vector& F, Index impulses, Index samples, const Whitening& whitened = {kOne, kOne}) {
  Matrix free(samples, impulses + 1);
  const Vector response = whitened(difference_equation(kOne, F, Vector::Unit(samples, 0)));
  for (Index j = 0; j < impulses; ++j) put_shifted(response, j, 1.0, free.col(j));
  free.col(impulses) = whitened(Vector::Ones(samples));
  return free;
}

/// Takes out of other columns what some columns explain.
class Projection {
 public:
  explicit Projection(const Matrix& columns) {
    if (columns.cols() > 0) qr_.emplace(columns);
  }
  [[nodiscard]] Vector coefficients(const Vector& of) const { return qr_ ? qr_->solve(of) : Vector(); }
  [[nodiscard]] Matrix rest(Matrix of) const { return qr_ && of.cols() > 0 ? qr_->rest(std::move(of)) : of; }

 private:
  std::optional<numeric::PivotedQr> qr_;
};

struct Model {
  Vector f, b, c, d;
};

bool is_stable(const Model& model) {
  return is_stable(model.f) && is_stable(model.c) && is_stable(model.d);
}

/// Coefficients that a search moves, in the order f, b, c, d.
struct Parts {
  bool denominator = false, numerator = false, noise = false;
};
constexpr Parts kDynamics{.denominator = true, .numerator = true};
constexpr Parts kNumerator{.numerator = true};
constexpr Parts kNoise{.noise = true};
constexpr Parts kAll{.denominator = true, .numerator = true, .noise = true};

/// One experiment at a model, free of its initial state and offset.
struct Local {
  Matrix slopes;  ///< ∂ε/∂θ
  Vector residual, innovation;
};

/// Σε² to first order, |R δ + r|² + rest.
struct Linear {
  Matrix R;
  Vector r;
  double squares = std::numeric_limits<double>::infinity();

  /// The least of it and of damping·|s δ|², s the lengths of R's columns.
  [[nodiscard]] Vector step(double damping) const {
    const Index p = R.cols();
    Vector scale = R.colwise().norm();
    for (double& s : scale) s = s > 0.0 ? 1.0 / s : 0.0;
    Matrix scaled(2 * p, p);
    scaled << R * scale.asDiagonal(), std::sqrt(damping) * Matrix::Identity(p, p);
    Vector right = Vector::Zero(2 * p);
    right.head(p) = -r;
    return scale.cwiseProduct(numeric::PivotedQr(scaled).solve(right));
  }
  /// (RᵀR)⁻¹
  [[nodiscard]] Matrix inverse() const {
    const Vector scale = R.colwise().norm().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
    const Matrix half = scale.asDiagonal() * numeric::PivotedQr(R * scale.asDiagonal()).inverse();
    return half * half.transpose();
  }
};

/// The triangle that stands for all rows so far and these, of which a few at a time stay in the nearest cache.
void add_rows(const Matrix& rows, Matrix& triangle) {
  const Index together = std::max<Index>(256, 4 * rows.cols());
  for (Index begin = 0; begin < rows.rows(); begin += together) {
    const Index count = std::min(together, rows.rows() - begin);
    Matrix all(triangle.rows() + count, rows.cols());
    if (triangle.rows() > 0) all.topRows(triangle.rows()) = triangle;
    all.bottomRows(count) = rows.middleRows(begin, count);
    triangle = numeric::householder_triangle(std::move(all));
  }
}

class Fitter {
 public:
  Fitter(const std::vector<SignalPair>& experiments, const PredictionErrorOptions& options)
      : experiments_(experiments), options_(options), n_(options.poles), q_(options.zeros + 1) {}

  Result<PredictionErrorFit> run();

 private:
  struct Search {
    SearchStart start;
    Model at;
    double squares = std::numeric_limits<double>::infinity();
  };
  struct Start {
    std::string made_by;
    Vector f;
  };
  using Signals = std::vector<Vector>;

  [[nodiscard]] Local local(const Model& at, std::size_t experiment, std::optional<Parts> slopes) const;
  [[nodiscard]] Linear linear(const Model& at, Parts parts) const;
  [[nodiscard]] double squares(const Model& at) const;
  [[nodiscard]] Model moved(Model at, Parts parts, const Vector& step) const;
  [[nodiscard]] Vector coefficients(const Model& at, Parts parts) const;
  void descend(Search& search, Parts parts, int passes) const;

  [[nodiscard]] Vector regress(const Vector& filter, const Signals& outputs, const Signals* instruments, Index poles,
                               Index zeros) const;
  [[nodiscard]] Signals responses(const Vector& theta, Index poles) const;
  [[nodiscard]] Model with_best_numerator(const Vector& f) const;
  [[nodiscard]] Search sharpened(const Start& start, int passes) const;
  [[nodiscard]] Search settled(const Start& start, const Vector& noise) const;
  [[nodiscard]] Result<std::vector<Search>> settled(const std::vector<Start>& starts, const Vector& noise) const;
  [[nodiscard]] Result<std::vector<Search>> with_noise(const std::vector<Start>& starts, std::vector<Search> white,
                                                       const Vector& noise) const;
  [[nodiscard]] std::vector<Start> starts(const ContinuousFit& continuous, const Vector& rich) const;
  [[nodiscard]] std::vector<Model> noise_models(const Model& at) const;
  void add_noise(Search& search) const;
  [[nodiscard]] Result<void> add_noise(std::vector<Search>& searches) const;
  [[nodiscard]] static bool is_better(const Search& a, const Search& b);
  void take_covariance(const Model& at, PredictionErrorFit& made) const;
  [[nodiscard]] double fit_of(const Model& at) const;

  const std::vector<SignalPair>& experiments_;
  const PredictionErrorOptions& options_;
  Index n_, q_, samples_ = 0;
  double step_ = 0, output_squares_ = 0;
  Signals outputs_;
};

Local Fitter::local(const Model& at, std::size_t experiment, std::optional<Parts> slopes) const {
  const SignalPair& pair = experiments_[experiment];
  const Index total = pair.output.size();
  const Vector F = monic(at.f), D = monic(at.d);
  const Whitening whitened{monic(at.c), D};
  Vector response = difference_equation(at.b, F, pair.input);
  Local made;
  made.residual = pair.output - response;
  const Projection projection(options_.free_start ? free_motion(F, n_, total, whitened) : Matrix(total, 0));
  if (options_.free_start) {
    const Matrix free = free_motion(F, n_, total);
    const Vector motion = projection.coefficients(whitened(made.residual));
    response += free.leftCols(n_) * motion.head(n_);
    made.residual -= free * motion;
  }
  made.innovation = whitened(made.residual);
  if (!slopes) return made;
  const Index f = slopes->denominator ? n_ : 0, b = slopes->numerator ? q_ : 0;
  const Index c = slopes->noise ? at.c.size() : 0, d = slopes->noise ? at.d.size() : 0;
  made.slopes.resize(total, f + b + c + d);
  if (f > 0) response = whitened(difference_equation(kOne, F, response));
  for (Index k = 0; k < f; ++k) put_shifted(response, k + 1, 1.0, made.slopes.col(k));
  const Vector input = b > 0 ? whitened(difference_equation(kOne, F, pair.input)) : Vector();
  for (Index k = 0; k < b; ++k) put_shifted(input, k, -1.0, made.slopes.col(f + k));
  const Vector v = c > 0 ? difference_equation(kOne, D, made.residual) : Vector();
  const Vector e = d > 0 ? difference_equation(kOne, D, made.innovation) : Vector();
  for (Index k = 0; k < c; ++k) put_shifted(v, k + 1, 1.0, made.slopes.col(f + b + k));
  for (Index k = 0; k < d; ++k) put_shifted(e, k + 1, -1.0, made.slopes.col(f + b + c + k));
  made.slopes = projection.rest(std::move(made.slopes));
  return made;
}

Linear Fitter::linear(const Model& at, Parts parts) const {
  Matrix triangle;
  Linear made;
  made.squares = 0.0;
  for (std::size_t k = 0; k < experiments_.size(); ++k) {
    Local one = local(at, k, parts);
    made.squares += one.innovation.squaredNorm();
    Matrix rows(one.slopes.rows(), one.slopes.cols() + 1);
    rows << one.slopes, one.innovation;
    add_rows(rows, triangle);
  }
  const Index p = triangle.cols() - 1;
  made.R = triangle.topLeftCorner(p, p);
  made.r = triangle.col(p).head(p);
  return made;
}

double Fitter::squares(const Model& at) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < experiments_.size(); ++k) sum += local(at, k, std::nullopt).innovation.squaredNorm();
  return sum;
}

Model Fitter::moved(Model at, Parts parts, const Vector& step) const {
  Index begin = 0;
  const auto move = [&](Vector& some, bool moves) {
    if (!moves) return;
    some += step.segment(begin, some.size());
    begin += some.size();
  };
  move(at.f, parts.denominator);
  move(at.b, parts.numerator);
  move(at.c, parts.noise);
  move(at.d, parts.noise);
  return at;
}

Vector Fitter::coefficients(const Model& at, Parts parts) const {
  const Vector none;
  const Vector &f = parts.denominator ? at.f : none, &b = parts.numerator ? at.b : none;
  const Vector &c = parts.noise ? at.c : none, &d = parts.noise ? at.d : none;
  Vector theta(f.size() + b.size() + c.size() + d.size());
  theta << f, b, c, d;
  return theta;
}

/// Levenberg (1944) & Marquardt (1963), until a full step of Gauss & Newton would hardly move a coefficient, and then
/// on to rounding.
void Fitter::descend(Search& search, Parts parts, int passes) const {
  constexpr double kFirstDamping = 1e-3, kMinDamping = 1e-9, kMaxDamping = 1e12, kLess = 0.1, kMore = 3.0;
  constexpr double kRounding = 1e-11;
  constexpr double kExact = 1e-22;  // of the output's squares: nothing is left but rounding
  constexpr int kRefinements = 8;
  double damping = kFirstDamping;
  SearchStart& start = search.start;
  start.converged = false;
  start.stable = true;
  int refinements = 0;
  Linear now = linear(search.at, parts);
  search.squares = now.squares;
  for (int pass = 0; pass < passes; ++pass, ++start.iterations) {
    const Vector full = now.step(0.0), theta = coefficients(search.at, parts);
    const double variance = now.squares / static_cast<double>(std::max<Index>(samples_ - theta.size(), 1));
    const Vector error = (variance * now.inverse().diagonal()).cwiseSqrt();
    const double change = (full.array().abs() / theta.array().abs().max(error.array())).maxCoeff();
    const bool exact = now.squares < kExact * output_squares_;
    if (!exact && !std::isfinite(change)) return;
    start.converged = exact || change < options_.tolerance;
    start.stable = start.converged || is_stable(moved(search.at, parts, full));
    if (start.converged) {
      if (change < kRounding || refinements++ == kRefinements) return;
      damping = 0.0;
    }
    bool moves = false;
    while (!moves && damping < kMaxDamping) {
      const Model trial = moved(search.at, parts, now.step(damping));
      const double reached = is_stable(trial) ? squares(trial) : std::numeric_limits<double>::infinity();
      moves = reached < now.squares;
      if (moves) {
        search.at = trial;
        damping = damping < kMinDamping ? 0.0 : kLess * damping;
      } else {
        if (start.converged) return;  // what is left is rounding
        damping = std::max(kMore * damping, kMinDamping);
      }
    }
    if (!moves) return;
    now = linear(search.at, parts);
    search.squares = now.squares;
  }
}

/// f and b of an equation-error model of the outputs through 1/filter, by least squares or by instruments.
Vector Fitter::regress(const Vector& filter, const Signals& outputs, const Signals* instruments, Index poles,
                       Index zeros) const {
  const Index p = poles + zeros + 1;
  const Vector F = monic(filter);
  Matrix triangle, ZX = Matrix::Zero(p, p);
  Vector Zy = Vector::Zero(p);
  for (std::size_t k = 0; k < experiments_.size(); ++k) {
    const Index total = outputs[k].size();
    const auto filtered = [&](const Vector& x) { return difference_equation(kOne, F, x); };
    const Vector y = filtered(outputs[k]), u = filtered(experiments_[k].input);
    const Vector x = instruments != nullptr ? filtered((*instruments)[k]) : Vector();
    Matrix columns(total, instruments != nullptr ? p + poles + 1 : p + 1);
    for (Index j = 0; j < poles; ++j) put_shifted(y, j + 1, -1.0, columns.col(j));
    for (Index j = 0; j <= zeros; ++j) put_shifted(u, j, 1.0, columns.col(poles + j));
    columns.col(p) = y;
    for (Index j = 0; j < poles && instruments != nullptr; ++j) put_shifted(x, j + 1, -1.0, columns.col(p + 1 + j));
    if (options_.free_start) columns = Projection(free_motion(F, poles, total)).rest(std::move(columns));
    if (instruments == nullptr) {
      add_rows(columns, triangle);
      continue;
    }
    Matrix Z(total, p);
    Z << columns.rightCols(poles), columns.middleCols(poles, zeros + 1);
    ZX += Z.transpose() * columns.leftCols(p);
    Zy += Z.transpose() * columns.col(p);
  }
  if (instruments != nullptr) return numeric::PivotedQr(ZX).solve(Zy);
  return Linear{triangle.topLeftCorner(p, p), -triangle.col(p).head(p)}.step(0.0);
}

/// Of an equation-error model, from rest and stable.
Fitter::Signals Fitter::responses(const Vector& theta, Index poles) const {
  Signals all;
  const Vector F = monic(stabilised(theta.head(poles)));
  for (const SignalPair& pair : experiments_) {
    all.push_back(difference_equation(theta.tail(theta.size() - poles), F, pair.input));
  }
  return all;
}

Model Fitter::with_best_numerator(const Vector& f) const {
  Model at{f, Vector::Zero(q_), {}, {}};
  return moved(at, kNumerator, linear(at, kNumerator).step(0.0));
}

/// Steiglitz & McBride (1965): least squares behind 1/F of the last pass, until that leaves no less; the best of the
/// passes is kept.   @param passes 1: the start as it is, with its best numerator
Fitter::Search Fitter::sharpened(const Start& start, int passes) const {
  constexpr double kLess = 1e-4;
  Search search;
  search.start.made_by = start.made_by;
  double modulus = 0.0;
  for (const auto& z : numeric::polynomial_roots(monic(start.f).reverse()))
    modulus += std::log(std::abs(std::log(z)) / step_);
  search.start.pole = std::exp(modulus / static_cast<double>(n_));
  Vector now = start.f;
  double last = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < passes; ++pass) {
    Model at = with_best_numerator(now);
    const double sum = at.b.allFinite() ? squares(at) : std::numeric_limits<double>::infinity();
    if (sum < search.squares || pass == 0) {
      search.at = std::move(at);
      search.squares = sum;
    }
    if (pass + 1 == passes || std::abs(last - sum) <= kLess * sum) break;
    last = sum;
    const Vector theta = regress(now, outputs_, nullptr, n_, options_.zeros);
    now = stabilised(theta.head(n_));
  }
  return search;
}

bool Fitter::is_better(const Search& a, const Search& b) {
  return a.start.converged != b.start.converged ? a.start.converged : a.squares < b.squares;
}

/// The dynamics behind a noise model that is held, from a start sharpened; where that leads out of the stable models,
/// from the start as it is, as the sharpened one may stand in the valley of another minimum, or of none; and then from
/// where the first search was held up, with its poles moved away from the unit circle.
Fitter::Search Fitter::settled(const Start& start, const Vector& noise) const {
  constexpr int kSharpened = 12;
  const auto descended = [&](Search search) {
    if (std::isfinite(search.squares)) {
      search.at.c = noise;
      descend(search, kDynamics, options_.max_iterations);
    }
    return search;
  };
  Search first = descended(sharpened(start, kSharpened));
  if (first.start.converged || !first.at.f.allFinite()) return first;
  for (const Vector& f : {start.f, moved_inside(first.at.f)}) {
    Search next = descended(sharpened({start.made_by, f}, 1));
    next.start.pole = first.start.pole;
    if (next.start.converged) return next;
  }
  return first;
}

Result<std::vector<Fitter::Search>> Fitter::settled(const std::vector<Start>& starts, const Vector& noise) const {
  std::vector<Search> searches(starts.size());
  const auto ran = numeric::parallel_for(static_cast<int>(starts.size()), options_.threads, [&](int i) -> Result<void> {
    const auto k = static_cast<std::size_t>(i);
    searches[k] = settled(starts[k], noise);
    return {};
  });
  if (!ran) return tl::unexpected(ran.error());
  return searches;
}

/// From the same starts behind the noise that is held, and from the best of those without a noise model.
Result<std::vector<Fitter::Search>> Fitter::with_noise(const std::vector<Start>& starts, std::vector<Search> white,
                                                       const Vector& noise) const {
  auto searches = settled(starts, noise);
  if (!searches) return searches;
  Search& best = *std::ranges::min_element(white, is_better);
  best.start.made_by = "output error";
  searches->push_back(std::move(best));
  if (auto ok = add_noise(*searches); !ok) return tl::unexpected(ok.error());
  return searches;
}

std::vector<Fitter::Start> Fitter::starts(const ContinuousFit& continuous, const Vector& rich) const {
  std::vector<Start> all;
  const auto add = [&](std::string made_by, const Vector& f) {
    if (f.allFinite()) all.push_back({std::move(made_by), stabilised(f)});
  };
  if (continuous.a.size() == n_ && continuous.a.allFinite()) {
    Vector A(n_ + 1);
    A << continuous.a, 1.0;
    add("continuous time", from_roots((numeric::polynomial_roots(A) * step_).array().exp()));
  }
  const Vector none;
  add("reduced", regress(none, responses(rich, rich.size() / 2), nullptr, n_, options_.zeros).head(n_));
  const Vector plain = regress(none, outputs_, nullptr, n_, options_.zeros);
  if (plain.allFinite()) {
    add("equation error", plain.head(n_));
    const Signals clean = responses(plain, n_);
    add("instruments", regress(stabilised(plain.head(n_)), outputs_, &clean, n_, options_.zeros).head(n_));
  }
  std::vector<double> poles = options_.start_poles;
  constexpr double kNyquistShares[] = {0.3, 0.05, 0.008};
  for (const double share : kNyquistShares) poles.push_back(share * std::numbers::pi / step_);
  for (const double pole : poles) {
    add("real poles", from_roots(Eigen::VectorXcd::Constant(n_, std::exp(-pole * step_))));
  }
  return all;
}

/// The dynamics with no c and d, with 1, 2 … of each, and with c alone, the least BIC first. The first values are those
/// of Hannan & Rissanen (1982), least squares on the innovations of a long autoregression, and a few steps from them
/// tell the orders apart.
std::vector<Model> Fitter::noise_models(const Model& at) const {
  constexpr Index kLong = 50;
  constexpr int kSteps = 3, kPatience = 2;
  const auto count = static_cast<double>(samples_);
  const Model white{at.f, at.b, {}, {}};
  Signals left;
  for (std::size_t k = 0; k < experiments_.size(); ++k) left.push_back(local(white, k, std::nullopt).residual);
  std::vector<std::pair<double, Model>> all;
  const auto add = [&](Model model, double sum) {
    const auto coefficients = static_cast<double>(model.c.size() + model.d.size());
    all.emplace_back(count * std::log(sum) + coefficients * std::log(count), std::move(model));
    return all.back().first;
  };
  double least = add(white, squares(white));
  const Vector longest = dsp::autoregression(left, std::min(kLong, samples_ / 20));
  const Index most = options_.max_noise_order;
  Matrix triangle;
  for (const Vector& v : left) {
    const Vector e = difference_equation(longest, kOne, v);
    Matrix columns(v.size(), 2 * most + 1);
    for (Index j = 0; j < most; ++j) {
      put_shifted(v, j + 1, -1.0, columns.col(2 * j));
      put_shifted(e, j + 1, 1.0, columns.col(2 * j + 1));
    }
    columns.col(2 * most) = v;
    add_rows(columns, triangle);
  }
  for (Index order = 1, rises = 0; order <= most && rises < kPatience; ++order, ++rises) {
    const Vector theta =
        Linear{triangle.topLeftCorner(2 * order, 2 * order), -triangle.col(2 * most).head(2 * order)}.step(0.0);
    Search search;
    search.at = {at.f, at.b, stabilised(theta(Eigen::seqN(0, order, 2))), stabilised(theta(Eigen::seqN(1, order, 2)))};
    descend(search, kNoise, kSteps);
    if (add(search.at, search.squares) >= least) continue;
    least = all.back().first;
    rises = -1;
  }
  const Vector c = dsp::autoregression(left, most);
  if (c.size() > 1) {
    Model autoregressive = white;
    autoregressive.c = c.tail(c.size() - 1);
    add(autoregressive, squares(autoregressive));
  }
  std::ranges::stable_sort(all, {}, &std::pair<double, Model>::first);
  std::vector<Model> models;
  for (auto& [bic, model] : all) models.push_back(std::move(model));
  return models;
}

/// All coefficients at once, with the noise model of least BIC that settles inside the stable ones. One zero of D at
/// z = 1, where the offset took all there was, is no model, and another order does without.
void Fitter::add_noise(Search& search) const {
  constexpr std::size_t kMost = 6;
  Search best;
  const std::vector<Model> models = noise_models(search.at);
  for (std::size_t k = 0; k < std::min(kMost, models.size()) && !best.start.converged; ++k) {
    Search one{search.start, models[k], search.squares};
    descend(one, kAll, options_.max_iterations);
    if (k == 0 || is_better(one, best)) best = std::move(one);
  }
  search = std::move(best);
}

/// Of searches that ended on the same dynamics one goes on, and the others share what it finds.
Result<void> Fitter::add_noise(std::vector<Search>& searches) const {
  constexpr double kSame = 1e-6;
  const auto are_same = [](const Search& a, const Search& b) {
    return a.start.converged == b.start.converged && std::abs(a.squares - b.squares) <= kSame * b.squares;
  };
  std::vector<std::size_t> leader(searches.size()), leaders;
  for (std::size_t k = 0; k < searches.size(); ++k) {
    const auto known = std::ranges::find_if(leaders, [&](std::size_t i) { return are_same(searches[k], searches[i]); });
    leader[k] = known == leaders.end() ? k : *known;
    if (leader[k] == k && std::isfinite(searches[k].squares)) leaders.push_back(k);
  }
  const auto ran =
      numeric::parallel_for(static_cast<int>(leaders.size()), options_.threads, [&](int i) -> Result<void> {
        add_noise(searches[leaders[static_cast<std::size_t>(i)]]);
        return {};
      });
  for (std::size_t k = 0; k < searches.size(); ++k) {
    if (leader[k] == k) continue;
    const SearchStart own = searches[k].start;
    searches[k] = searches[leader[k]];
    searches[k].start.made_by = own.made_by;
    searches[k].start.pole = own.pole;
  }
  return ran;
}

double Fitter::fit_of(const Model& at) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < experiments_.size(); ++k) sum += local(at, k, std::nullopt).residual.squaredNorm();
  return 1.0 - sum / output_squares_;
}

void Fitter::take_covariance(const Model& at, PredictionErrorFit& made) const {
  const Matrix bread = linear(at, kAll).inverse();
  Matrix covariance = made.variance * bread;
  const Index p = n_ + q_, all = bread.rows();
  made.white_covariance = covariance.topLeftCorner(p, p);
  if (options_.hac_lag_s > 0.0) {
    Matrix scores(all, samples_);
    std::vector<numeric::RowRange> ranges;
    Index begin = 0;
    for (std::size_t k = 0; k < experiments_.size(); ++k) {
      const Local one = local(at, k, kAll);
      const Index count = one.innovation.size();
      scores.middleCols(begin, count) = one.slopes.transpose() * one.innovation.asDiagonal();
      ranges.push_back({begin, begin + count});
      begin += count;
    }
    const Index lags = std::min(static_cast<Index>(std::llround(options_.hac_lag_s / step_)), samples_ / 10);
    const Matrix middle = numeric::long_run_covariance(all, ranges, lags, [&](const numeric::RowRange& range) {
      return Matrix(scores.middleCols(range.begin, range.size()).transpose());
    });
    const double widening = numeric::newey_west_widening(static_cast<double>(lags) / static_cast<double>(samples_));
    covariance = widening * widening * bread * middle * bread.transpose();
  }
  made.covariance = covariance.topLeftCorner(p, p);
}

Result<PredictionErrorFit> Fitter::run() {
  const auto step = common_step(experiments_);
  if (!step) return tl::unexpected(step.error());
  step_ = *step;
  for (const SignalPair& pair : experiments_) samples_ += pair.output.size();
  ContinuousFitOptions continuous_options;
  continuous_options.poles = n_;
  continuous_options.zeros = options_.zeros;
  continuous_options.start_poles = options_.start_poles;
  continuous_options.free_start = options_.free_start;
  continuous_options.threads = options_.threads;
  const auto continuous = fit_continuous(experiments_, continuous_options);  // it also looks at the data
  if (!continuous) return tl::unexpected(continuous.error());
  for (const SignalPair& pair : experiments_) {
    output_squares_ += (pair.output.array() - pair.output.mean()).square().sum();
    outputs_.push_back(pair.output);
  }
  constexpr Index kRich = 40, kSamplesEach = 30;
  const Index high = std::clamp(samples_ / kSamplesEach / std::ssize(experiments_), n_, kRich);
  Vector rich = regress(Vector(), outputs_, nullptr, high, high);
  if (!rich.allFinite()) rich.setZero();
  const std::vector<Start> first = starts(*continuous, rich);
  auto found = settled(first, Vector());
  if (found && options_.noise_model) found = with_noise(first, std::move(*found), stabilised(rich.head(high)));
  if (!found) return tl::unexpected(found.error());
  std::vector<Search>& searches = *found;
  for (Search& one : searches) one.start.fit = fit_of(one.at);
  const Search& best = *std::ranges::min_element(searches, is_better);
  PredictionErrorFit made;
  made.samples = samples_;
  for (const Search& one : searches) made.starts.push_back(one.start);
  made.converged = best.start.converged;
  made.stable = best.start.stable;
  made.fit = best.start.fit;
  made.f = best.at.f;
  made.b = best.at.b;
  made.noise_denominator = monic(best.at.c);
  made.noise_numerator = monic(best.at.d);
  const Index parameters = coefficients(best.at, kAll).size();
  made.variance = best.squares / static_cast<double>(std::max<Index>(samples_ - parameters, 1));
  if (!std::isfinite(made.variance)) return made;
  take_covariance(best.at, made);
  for (std::size_t k = 0; k < experiments_.size(); ++k) {
    Local one = local(best.at, k, std::nullopt);
    made.residuals.push_back(std::move(one.residual));
    made.innovations.push_back(std::move(one.innovation));
  }
  return made;
}

}  // namespace

Result<PredictionErrorFit> fit_prediction_error(const std::vector<SignalPair>& experiments,
                                                const PredictionErrorOptions& options) {
  return Fitter(experiments, options).run();
}

Result<double> common_step(const std::vector<SignalPair>& experiments, const std::vector<SignalPair>& held_out) {
  double step = 0.0;
  constexpr double kSame = 1e-4;
  for (const auto* pairs : {&experiments, &held_out}) {
    for (const SignalPair& pair : *pairs) {
      if (!pair.step) {
        return bad_usage("a discrete-time model needs an even clock",
                         "take --method srivc, or put the clock right by --resample");
      }
      if (step == 0.0) step = *pair.step;
      if (std::abs(*pair.step - step) <= kSame * step) continue;
      return bad_usage(fmt::format("samples every {:.6g} ms and every {:.6g} ms are no one discrete-time model",
                                   1e3 * step, 1e3 * *pair.step),
                       "take --method srivc, or one clock for all by --resample");
    }
  }
  return step;
}

Vector without_discrete_free_motion(const Vector& f, const Vector& residual) {
  return Projection(free_motion(monic(f), f.size(), residual.size())).rest(residual);
}

}  // namespace mbk::identify
