#include "tests/reference/quad_procedure.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "tests/reference/quad_filters.h"

namespace mbk::reference {
namespace {

using Size = std::size_t;

constexpr Size kRegressors = 7;  // ẍ ÿ ẋ ẏ x y 1

Quad sample_time() {
  return Quad(1) / 1000;
}

/// Smoothed signals at the centres first + i, i < count, of the log.
struct Smoothed {
  Size first = 0;
  Size count = 0;
  std::vector<Signal> regressors;  // kRegressors columns
  std::vector<Signal> force;       // F_x, F_y
};

struct Split {
  std::vector<Size> identify;
  std::vector<Size> validate;
};

Result<void> check(const Log& log, const Settings& settings) {
  std::vector<std::pair<const char*, const std::vector<double>*>> rows = {
      {"x", &log.x}, {"y", &log.y}, {"Fx", &log.Fx}, {"Fy", &log.Fy}, {"xr", &log.xr}, {"yr", &log.yr}};
  if (settings.procedure == Procedure::chapter5) {
    if (!settings.handle_mass) return bad_usage("the procedure of chapter 5 needs the handle's mass");
    rows.insert(rows.end(), {{"ax", &log.ax}, {"ay", &log.ay}});
  }
  for (const auto& [name, row] : rows) {
    if (row->size() != log.x.size()) {
      return bad_data(fmt::format("{} has {} samples, but x has {}", name, row->size(), log.x.size()));
    }
    for (Size i = 0; i < row->size(); ++i) {
      if (!std::isfinite((*row)[i])) return bad_data(fmt::format("{} is not finite at sample {}", name, i));
    }
  }
  return {};
}

/// Steps 1–3: cut, Savitzky–Golay, zero-phase Butterworth.
Result<Smoothed> smooth(const Log& log, const Settings& settings) {
  const bool chapter3 = settings.procedure == Procedure::chapter3;
  const bool sinusoidal = settings.protocol == Protocol::sinusoidal;
  const int window = chapter3 ? 101 : 151;
  const Quad cutoff_hz = chapter3 ? 5 : Quad(9) / 2;
  const Size h = static_cast<Size>(window - 1) / 2;
  const Size s0 = sinusoidal ? 11999 : 15999;
  const Size s1 = sinusoidal ? 62000 : log.x.size();
  if (log.x.size() < s1 || s1 < s0 + 1000) {
    return bad_data(fmt::format("{} samples are too few: the published procedure reads {} and more", log.x.size(),
                                sinusoidal ? s1 : s0 + 1000));
  }
  const Filter low_pass = butterworth(5, cutoff_hz, 1 / sample_time());
  Smoothed out{s0 + h + 1, s1 - s0 - 2 * (h + 1), {}, {}};
  const auto smoothed = [&](const std::vector<double>& row, int derivative) {
    const Signal weights = savitzky_golay_weights(6, window, derivative, sample_time());
    const Signal samples(row.begin(), row.end());
    Signal y(out.count, 0);
    for (Size i = 0; i < out.count; ++i) {
      for (Size j = 0; j < weights.size(); ++j) y[i] += weights[j] * samples[out.first + i - h + j];
    }
    return zero_phase(low_pass, y);
  };
  out.regressors = {chapter3 ? smoothed(log.x, 2) : smoothed(log.ax, 0),
                    chapter3 ? smoothed(log.y, 2) : smoothed(log.ay, 0),
                    smoothed(log.x, 1),
                    smoothed(log.y, 1),
                    smoothed(log.x, 0),
                    smoothed(log.y, 0),
                    Signal(out.count, 1)};
  out.force = {smoothed(log.Fx, 0), smoothed(log.Fy, 0)};
  return out;
}

/// Step 4: which samples identify and which validate.
Result<Split> split(const Log& log, Protocol protocol, const Smoothed& s) {
  Split parts;
  if (protocol == Protocol::sinusoidal) {
    for (Size i = 0; i < s.count; ++i) (i < 40000 ? parts.identify : parts.validate).push_back(i);
    return parts;
  }
  const Size s0 = 15999;
  const auto displaced = [&](Size i) { return log.xr[s.first + i] != log.xr[s0] || log.yr[s.first + i] != log.yr[s0]; };
  int onsets = 0;
  for (Size i = 0; i < s.count; ++i) {
    if (displaced(i)) (onsets < 9 ? parts.identify : parts.validate).push_back(i);
    if (i + 1 < s.count && !displaced(i) && displaced(i + 1)) ++onsets;
  }
  if (onsets < 9) return bad_data(fmt::format("{} onsets of the reference; the published split needs 9", onsets));
  return parts;
}

std::vector<Signal> pick(const std::vector<Signal>& columns, const std::vector<Size>& samples) {
  std::vector<Signal> picked;
  for (const Signal& column : columns) {
    Signal& out = picked.emplace_back();
    for (const Size i : samples) out.push_back(column[i]);
  }
  return picked;
}

std::vector<Signal> negative(std::vector<Signal> columns) {
  for (Signal& column : columns) {
    for (Quad& value : column) value = -value;
  }
  return columns;
}

/// Columns of P with [ẍ ÿ ẋ ẏ x y 1] P ≈ −F.
std::vector<Signal> parameters(const Smoothed& s, const std::vector<Size>& samples) {
  return least_squares(pick(s.regressors, samples), negative(pick(s.force, samples)));
}

/// M, B, K and x₀ of P, beside the VAF of the split.
Answer as_answer(const std::vector<Signal>& P, Quad handle_mass, const std::array<double, 2>& VAF) {
  Answer answer{};
  answer.VAF = VAF;
  for (Size axis = 0; axis < 2; ++axis) {
    for (Size k = 0; k < 2; ++k) {
      answer.M[2 * axis + k] = static_cast<double>(P[axis][k] - (axis == k ? handle_mass : 0));
      answer.B[2 * axis + k] = static_cast<double>(P[axis][2 + k]);
      answer.K[2 * axis + k] = static_cast<double>(P[axis][4 + k]);
    }
  }
  const Signal &px = P[0], &py = P[1];  // x₀ = −K⁻¹ c, c the coefficients of the 1
  const Quad determinant = px[4] * py[5] - px[5] * py[4];
  answer.x0[0] = static_cast<double>(-(py[5] * px[6] - px[5] * py[6]) / determinant);
  answer.x0[1] = static_cast<double>(-(px[4] * py[6] - py[4] * px[6]) / determinant);
  return answer;
}

/// Variance with the n − 1 normalisation.
Quad variance(const Signal& signal) {
  Quad mean = 0, sum = 0;
  for (const Quad value : signal) mean += value;
  mean /= signal.size();
  for (const Quad value : signal) sum += (value - mean) * (value - mean);
  return sum / (signal.size() - 1);
}

/// 100 (1 − var(F + Z p)/var F) [%]
Quad variance_accounted_for(const std::vector<Signal>& Z, const Signal& force, const Signal& p) {
  Signal residual = force;
  for (Size i = 0; i < force.size(); ++i) {
    for (Size k = 0; k < kRegressors; ++k) residual[i] += Z[k][i] * p[k];
  }
  return 100 * (1 - variance(residual) / variance(force));
}

}  // namespace

Result<Answers> identify(const Log& log, const Settings& settings) {
  if (const auto valid = check(log, settings); !valid) return tl::unexpected(valid.error());
  const auto smoothed = smooth(log, settings);
  if (!smoothed) return tl::unexpected(smoothed.error());
  const auto parts = split(log, settings.protocol, *smoothed);
  if (!parts) return tl::unexpected(parts.error());
  if (parts->identify.size() < kRegressors || parts->validate.size() < 2) {
    return bad_data(fmt::format("{} samples to identify and {} to validate: too few", parts->identify.size(),
                                parts->validate.size()));
  }

  const std::vector<Signal> held_in = parameters(*smoothed, parts->identify);
  const std::vector<Signal> Z = pick(smoothed->regressors, parts->validate);
  const std::vector<Signal> force = pick(smoothed->force, parts->validate);
  std::vector<Size> every = parts->identify;
  every.insert(every.end(), parts->validate.begin(), parts->validate.end());

  std::array<double, 2> VAF{};
  for (Size axis = 0; axis < 2; ++axis) {
    VAF[axis] = static_cast<double>(variance_accounted_for(Z, force[axis], held_in[axis]));
  }
  const Quad handle_mass = settings.handle_mass.value_or(0.0);
  return Answers{as_answer(held_in, handle_mass, VAF), as_answer(parameters(*smoothed, every), handle_mass, VAF)};
}

}  // namespace mbk::reference
