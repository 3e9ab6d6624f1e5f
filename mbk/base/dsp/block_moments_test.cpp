#include "mbk/base/dsp/block_moments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace mbk::dsp {
namespace block_moments_test {

constexpr double kTolerance = 1e-13;  // of numbers about 1, some hundred of them

std::vector<double> numbers(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> all(count);
  for (double& value : all) value = normal(random);
  return all;
}

/// φ_k of the later half, from the end on, that of the centre of an odd length halved.
double shape(const BlockFilter& f, Index i, std::size_t k) {
  return f.shapes[(static_cast<std::size_t>(i / 4) * kMoments + k) * 4 + static_cast<std::size_t>(i % 4)];
}

BlockFilter filter(Index length, std::size_t states) {
  const Index pairs = (length + 1) / 2, fours = (pairs + 3) / 4;
  BlockFilter f{length, states, numbers(static_cast<std::size_t>(fours) * 4 * kMoments, 1),
                numbers(kMoments * states, 2), numbers(states, 3)};
  for (double& p : f.power) p = 0.6 * std::tanh(p);
  for (Index i = pairs; i < 4 * fours; ++i) {
    for (std::size_t k = 0; k < kMoments; ++k) {
      f.shapes[(static_cast<std::size_t>(i / 4) * kMoments + k) * 4 + static_cast<std::size_t>(i % 4)] = 0.0;
    }
  }
  return f;
}

TEST(BlockMoments, AreThoseOfTheSamplesOfEachBlock) {
  constexpr Index kBlocks = 5;
  for (const Index length : {4, 5, 9, 20, 33}) {
    const BlockFilter f = filter(length, 1);
    const auto samples = numbers(static_cast<std::size_t>(kLanes * kBlocks * length), 4);
    FourColumns columns{};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      columns[lane] = samples.data() + static_cast<Index>(lane) * kBlocks * length;
    }
    const FourValues less = {0.5, -1.0, 2.0, 0.0};
    std::vector<double> moments(kLanes * kMoments * kBlocks);
    take_moments(f, columns, less, kBlocks, moments.data());
    for (Index b = 0; b < kBlocks; ++b) {
      for (std::size_t k = 0; k < kMoments; ++k) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
          double want = 0.0;
          for (Index i = 0; i < (length + 1) / 2; ++i) {
            const double older = columns[lane][b * length + i] - less[lane];
            const double newer = columns[lane][(b + 1) * length - 1 - i] - less[lane];
            want += shape(f, i, k) * (k % 2 == 0 ? newer + older : newer - older);
          }
          EXPECT_NEAR(moments[(static_cast<std::size_t>(b) * kMoments + k) * kLanes + lane], want, kTolerance)
              << "L " << length << ", block " << b << ", k " << k << ", lane " << lane;
        }
      }
    }
  }
}

TEST(BlockMoments, LeadFromStatesToStatesInBothDirections) {
  constexpr Index kBlocks = 7;
  for (std::size_t states = 1; states <= kMaxModalStates; ++states) {
    const BlockFilter f = filter(20, states);
    const auto moments = numbers(kLanes * kMoments * kBlocks, 5);
    for (const Looking way : {Looking::back, Looking::ahead}) {
      const bool back = way == Looking::back;
      std::vector<double> rows = numbers(kLanes * states * (kBlocks + 1), 6);
      const std::vector<double> before = rows;
      const std::size_t width = kLanes * states;
      double* const first = rows.data() + (back ? width : 0);
      advance_modes(f, way, kBlocks, moments.data(), first);
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        std::vector<double> x(states);
        for (std::size_t s = 0; s < states; ++s) x[s] = before[(back ? 0 : kBlocks * width) + kLanes * s + lane];
        for (std::size_t step = 0; step < kBlocks; ++step) {
          const std::size_t b = back ? step : kBlocks - 1 - step;
          std::vector<double> next(states);
          if (states % 2 == 1) next[0] = f.power[0] * x[0];
          for (std::size_t s = states % 2; s < states; s += 2) {
            next[s] = f.power[s] * x[s] - f.power[s + 1] * x[s + 1];
            next[s + 1] = f.power[s] * x[s + 1] + f.power[s + 1] * x[s];
          }
          for (std::size_t s = 0; s < states; ++s) {
            for (std::size_t k = 0; k < kMoments; ++k) {
              const double sign = back || k % 2 == 0 ? 1.0 : -1.0;
              next[s] += sign * f.drive[k * states + s] * moments[(b * kMoments + k) * kLanes + lane];
            }
            EXPECT_NEAR(first[static_cast<Index>(b * width + kLanes * s + lane)], next[s], kTolerance)
                << states << " states, block " << b;
          }
          x = next;
        }
      }
    }
  }
}

TEST(BlockMoments, AreWeightedForEveryDerivative) {
  constexpr std::size_t kTerms = 13, kSums = 6, kApart = 8;
  const auto terms = numbers(kLanes * kTerms + kApart * kSums, 7);
  for (std::size_t derivatives = 1; derivatives <= kMaxDerivatives; ++derivatives) {
    const auto weights = numbers(derivatives * kTerms, 8);
    const std::size_t width = kLanes * derivatives;
    for (const Sums how : {Sums::written, Sums::added}) {
      std::vector<double> sums = numbers(kSums * width, 9);
      const std::vector<double> before = sums;
      weighted_sums(weights, derivatives, {terms.data(), kTerms, kApart}, kSums, how, sums.data(),
                    static_cast<Index>(width));
      for (std::size_t i = 0; i < kSums; ++i) {
        for (std::size_t d = 0; d < derivatives; ++d) {
          for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::size_t at = i * width + kLanes * d + lane;
            double want = how == Sums::added ? before[at] : 0.0;
            for (std::size_t t = 0; t < kTerms; ++t) {
              want += weights[t * derivatives + d] * terms[i * kApart + kLanes * t + lane];
            }
            EXPECT_NEAR(sums[at], want, kTolerance) << derivatives << " derivatives, sum " << i;
          }
        }
      }
    }
  }
}

}  // namespace block_moments_test
}  // namespace mbk::dsp
