#include "mbk/files/xdf/xdf_clocks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "mbk/base/numeric/statistics.h"
#include "mbk/files/xdf/test_xdf.h"
#include "mbk/files/xdf/xdf.h"

namespace mbk::recording {
namespace xdf_clocks_test {

using test::raw;
using test::Xdf;
using testing::Contains;
using testing::HasSubstr;

constexpr double kBegin = 2000.0;  ///< [s] on the recorder's clock, of the first sample
constexpr double kRight = 1e-4;    ///< [s], to which stamps have to be right

using OfTime = std::function<double(double)>;  ///< of the seconds since the first sample

OfTime drift(double ppm) {
  return [=](double t) { return 1e-6 * ppm * t; };
}
OfTime step(double at, double size) {
  return [=](double t) { return t < at ? 0.0 : size; };
}
OfTime sum(OfTime a, OfTime b) {
  return [=](double t) { return a(t) + b(t); };
}

/// The k-th of some normal numbers.
double normal(int k) {
  static const std::vector<double> numbers = [] {
    std::mt19937 random(7);
    std::normal_distribution<double> one;
    std::vector<double> all(100'000);
    for (double& number : all) number = one(random);
    return all;
  }();
  return numbers[static_cast<std::size_t>(k) % numbers.size()];
}

/// A stream whose samples are numbered, and whose sender's clock shows 1000 s + t + ahead(t).
struct Scene {
  double hz = 1000.0, seconds = 60.0, nominal = -1.0;
  double every = 5.0, first_offset = 0.3;
  OfTime ahead = drift(20.0);
  double jitter = 2e-5, noise = 2e-5;                         ///< [s], standard deviations of stamps and of offsets
  OfTime wrong = [](double) { return 0.0; };                  ///< [s], of the offset measured then
  std::function<bool(int)> lost = [](int) { return false; };  ///< of samples
  std::function<double(int)> late = [](int) { return 0.0; };  ///< [s], by which a sample was stamped
  int in_chunk = 200;
  std::function<void(std::vector<std::vector<std::string>>&)> shuffle = [](auto&) {};
  bool offsets_last = false;
  bool even_on_sender = false;  ///< the sender's clock tells when a sample is taken, and no other
  unsigned seed = 1;

  /// [s] since the first one.
  [[nodiscard]] double taken(double number) const {
    double t = number / hz;
    for (int round = 0; even_on_sender && round < 5; ++round) t = number / hz - ahead(t);
    return t;
  }

  [[nodiscard]] std::string bytes() const {
    std::mt19937 random(seed);
    std::normal_distribution<double> noisy;
    Xdf file;
    file.header().stream(1, "S", "double64", 1, nominal < 0 ? hz : nominal);
    std::vector<std::vector<std::string>> chunks(1);
    const int count = static_cast<int>(std::lround(seconds * hz));
    for (int k = 0; k < count; ++k) {
      const double t = taken(k), stamp = 1000.0 + t + ahead(t) + late(k) + jitter * noisy(random);
      if (std::ssize(chunks.back()) == in_chunk) chunks.emplace_back();
      if (!lost(k)) chunks.back().push_back(Xdf::stamped(stamp) + raw(static_cast<double>(k)));
    }
    shuffle(chunks);
    double next = first_offset;
    const auto write_offsets = [&](double until) {
      for (; every > 0.0 && next < std::min(until, seconds); next += every) {
        const double sender = 1000.0 + next + ahead(next);
        file.offset(1, sender, kBegin + next - sender + wrong(next) + noise * noisy(random));
      }
    };
    for (std::size_t c = 0; c < chunks.size(); ++c) {
      file.samples(1, chunks[c]);
      if (!offsets_last) write_offsets(static_cast<double>((c + 1) * static_cast<std::size_t>(in_chunk)) / hz);
    }
    write_offsets(seconds);
    return file.bytes();
  }
};

/// What was read of it.
struct Outcome {
  Vector number, error;             ///< of the samples, and [s] by which their times are off
  std::vector<std::string> doubts;  ///< notes that come before those on each stream
  std::vector<std::string> said;    ///< the others

  [[nodiscard]] double worst() const { return error.cwiseAbs().maxCoeff(); }
};

Outcome read(const std::string& bytes, const Scene& scene) {
  const auto contents = decode_xdf(std::as_bytes(std::span(bytes)));
  Outcome outcome;
  if (!contents) {
    ADD_FAILURE() << contents.error().line();
    return outcome;
  }
  const auto first =
      std::ranges::find_if(contents->notes, [](const auto& note) { return note.find("stream") != note.npos; });
  outcome.doubts.assign(contents->notes.begin(), first);
  outcome.said.assign(first, contents->notes.end());
  outcome.number = contents->arrays[0].values.reshaped();
  outcome.error =
      contents->clocks[0].time - outcome.number.unaryExpr([&](double number) { return kBegin + scene.taken(number); });
  return outcome;
}

Outcome read(const Scene& scene) {
  return read(scene.bytes(), scene);
}

struct Named {
  std::string name;
  Scene scene;
};

// ---- steps of the sender's clock ----

TEST(XdfClocks, StepsOfTheSendersClockAreTakenOut) {
  const auto with = [](double at, double size, auto... changes) {
    Scene scene;
    scene.ahead = sum(drift(20.0), step(at, size));
    (changes(scene), ...);
    return scene;
  };
  const auto few = [](Scene& s) { s.every = 20.0; };
  const auto last = [](Scene& s) { s.offsets_last = true; };
  const auto slow = [](Scene& s) { s.hz = 100.0; };
  const auto exact = [](Scene& s) { s.jitter = s.noise = 0.0; };
  const auto irregular = [](Scene& s) {
    s.nominal = 0.0;
    s.jitter = 5e-6;
  };
  const auto late = [](Scene& s) { s.first_offset = 2.0; };
  const Named scenes[] = {
      {"back by 20 ms", with(30.0, -0.020)},
      {"forward by 20 ms", with(30.0, 0.020)},
      {"20 ms, offsets behind all samples", with(30.0, -0.020, last)},
      {"20 ms, three offsets", with(30.0, -0.020, few)},
      {"20 ms, exact numbers", with(31.0, 0.020, exact)},
      {"20 ms at 100 Hz", with(31.0, 0.020, slow)},
      {"back by 20 ms at 100 Hz", with(31.0, -0.020, slow)},
      {"20 ms, no nominal rate", with(31.0, 0.020, irregular)},
      {"2 ms", with(30.0, 0.002)},
      {"0.5 ms", with(30.0, 0.0005)},
      {"0.8 s", with(30.0, 0.8)},
      {"3 s", with(30.0, 3.0)},
      {"3 s, offsets behind all samples", with(30.0, 3.0, last)},
      {"back by 0.8 s", with(30.0, -0.8)},
      {"back by 3 s", with(30.0, -3.0)},
      {"20 ms behind the first offset", with(3.0, 0.020)},
      {"20 ms before the last offset", with(54.0, 0.020)},
      {"0.8 s before the last offset", with(54.0, 0.8)},
      {"400 s", with(30.0, 400.0)},
      {"400 s, offsets behind all samples", with(30.0, 400.0, last)},
      {"back by 400 s", with(30.0, -400.0)},
      {"back by 400 s, offsets behind all samples", with(30.0, -400.0, last)},
      {"back by 1.8 s, offsets every 1.3 s", with(30.0, -1.8, [](Scene& s) { s.every = 1.3; })},
      {"back by 4 s, a drift of 100 ppm", with(32.0, -4.0, [](Scene& s) { s.ahead = sum(s.ahead, drift(80.0)); })},
      {"20 ms, the first offset late", with(30.0, 0.020, late)},
  };
  for (const auto& [name, scene] : scenes) {
    const Outcome outcome = read(scene);
    EXPECT_LT(outcome.worst(), kRight) << name;
    EXPECT_EQ(outcome.number.size(), std::lround(scene.seconds * scene.hz)) << name;
    EXPECT_THAT(outcome.doubts, Contains(HasSubstr("clock"))) << name;
  }
}

TEST(XdfClocks, SeveralStepsAreTakenOut) {
  Scene scene;
  scene.seconds = 120.0;
  scene.ahead = sum(sum(step(30.0, 0.020), step(47.0, -0.050)), sum(step(80.0, 1.5), step(99.0, 0.004)));
  const Outcome outcome = read(scene);
  EXPECT_LT(outcome.worst(), kRight);
  EXPECT_THAT(outcome.doubts, Contains(AllOf(HasSubstr(" 4 "), HasSubstr("step"))));
  scene.ahead = sum(step(53.0, 2.4), sum(step(58.0, 0.09), step(63.0, -0.06)));  // one after the other
  EXPECT_LT(read(scene).worst(), kRight);
  scene.ahead = [](double t) { return 0.010 * std::floor(t / 12.0); };
  const Outcome stairs = read(scene);
  EXPECT_LT(stairs.worst(), kRight);
}

TEST(XdfClocks, AStepBetweenNoisyOffsetsIsTakenOutWhereStampsShowIt) {
  Scene scene;
  scene.seconds = 300.0;
  scene.noise = 1e-3;
  scene.ahead = step(150.0, 0.020);
  const Outcome outcome = read(scene);
  EXPECT_LT(outcome.worst(), 1e-3);  // what the noise of offsets leaves
  EXPECT_THAT(outcome.doubts, Contains(HasSubstr("+20.0")));
}

TEST(XdfClocks, APauseInWhichTheClockWasSetStays) {
  for (const double size : {0.8, 3.0, -0.8}) {
    Scene scene;
    scene.ahead = step(31.0, size);
    scene.lost = [](int k) { return k > 30500 && k < 33700; };
    const Outcome outcome = read(scene);
    EXPECT_LT(outcome.worst(), kRight) << size;
    EXPECT_THAT(outcome.doubts, Contains(HasSubstr("clock"))) << size;
  }
}

TEST(XdfClocks, AStepThatStampsDoNotShowLeavesOutWhatIsUnsure) {
  Scene scene;
  // The recorder's clock was set: the offsets change, and no stamp does.
  scene.wrong = step(30.0, 0.020);
  const Outcome outcome = read(scene);
  EXPECT_EQ(outcome.number.size(), 55000);
  for (Index k = 0; k < outcome.number.size(); ++k) {
    ASSERT_NEAR(outcome.error[k], outcome.number[k] < 30000.0 ? 0.0 : 0.020, kRight) << outcome.number[k];
  }
  EXPECT_THAT(outcome.doubts, Contains(AllOf(HasSubstr("25302"), HasSubstr("30301"))));
}

TEST(XdfClocks, EventsAreMovedWithTheirClock) {
  for (const double size : {0.020, 3.0, -3.0}) {
    Xdf file;
    file.header().stream(1, "S", "string", 1, 0);
    const OfTime ahead = step(32.0, size);
    const auto at = [](double k) { return k + 0.9 * std::sin(10.0 * k); };
    for (int k = 0; k < 60; ++k) {
      if (k % 5 == 0) file.offset(1, 1000.0 + k + ahead(k), kBegin - 1000.0 - ahead(k) + 1e-5 * normal(k));
      if (k % 3 == 1) file.samples(1, {Xdf::stamped(1000.0 + at(k) + ahead(at(k))) + Xdf::text(std::to_string(k))});
    }
    const std::string bytes = file.bytes();
    const auto contents = decode_xdf(std::as_bytes(std::span(bytes)));
    ASSERT_TRUE(contents);
    EXPECT_EQ(contents->events.size(), 20u);
    for (const Event& event : contents->events) {
      const bool unsure = at(event.value) > 30.0 && at(event.value) < 35.0;  // between two offsets
      EXPECT_NEAR(event.time, kBegin + at(event.value), unsure && size < 3.0 ? std::abs(size) + kRight : kRight)
          << size;
    }
    EXPECT_THAT(contents->notes, Contains(HasSubstr(size < 3.0 ? "step" : "sender"))) << size;
  }
}

TEST(XdfClocks, OffsetsThatStandOutOfOrderAreNoReset) {
  Scene scene;
  std::string bytes = scene.bytes();
  const std::string chunk_head = std::string("\x01\x16\x04", 3);  // a clock offset, with its length in one byte
  const auto first = bytes.find(chunk_head), second = bytes.find(chunk_head, first + 1);
  ASSERT_NE(second, bytes.npos);
  std::swap_ranges(bytes.begin() + static_cast<std::ptrdiff_t>(first),
                   bytes.begin() + static_cast<std::ptrdiff_t>(first) + 24,
                   bytes.begin() + static_cast<std::ptrdiff_t>(second));
  const Outcome outcome = read(bytes, scene);
  EXPECT_LT(outcome.worst(), kRight);
  EXPECT_THAT(outcome.doubts, testing::IsEmpty());
}

TEST(XdfClocks, OffsetsThatContradictEachOtherSayHowFarTimeMayBeOff) {
  Scene two;
  two.seconds = 9.0;
  two.wrong = step(4.0, 0.010);
  EXPECT_LT(read(two).worst(), 0.0055);
  EXPECT_THAT(read(two).doubts, Contains(HasSubstr("4.9")));

  Scene three;
  three.every = 20.0;
  three.wrong = step(39.0, 0.5);
  EXPECT_LT(read(three).worst(), 2e-3);
  EXPECT_THAT(read(three).doubts, Contains(HasSubstr("median")));

  Scene fast;
  fast.ahead = drift(400.0);
  EXPECT_LT(read(fast).worst(), kRight);
  EXPECT_THAT(read(fast).doubts, Contains(HasSubstr("-400 µs/s")));
}

// ---- order ----

TEST(XdfClocks, ChunksOutOfOrderAreSorted) {
  using Chunks = std::vector<std::vector<std::string>>;
  const std::pair<std::string, std::function<void(Chunks&)>> shuffles[] = {
      {"two swapped", [](Chunks& chunks) { std::swap(chunks[100], chunks[101]); }},
      {"two far ones swapped", [](Chunks& chunks) { std::swap(chunks[40], chunks[150]); }},
      {"one late", [](Chunks& chunks) { std::rotate(chunks.begin() + 60, chunks.begin() + 61, chunks.begin() + 70); }},
      {"reversed", [](Chunks& chunks) { std::ranges::reverse(chunks); }},
      {"shuffled", [](Chunks& chunks) { std::shuffle(chunks.begin(), chunks.end(), std::mt19937(3)); }},
      {"the second half first",
       [](Chunks& chunks) { std::rotate(chunks.begin(), chunks.begin() + 150, chunks.end()); }},
  };
  for (const auto& [name, shuffle] : shuffles) {
    for (const int in_chunk : {200, 5}) {
      Scene scene;
      scene.in_chunk = in_chunk;
      scene.shuffle = shuffle;
      scene.offsets_last = true;
      const Outcome outcome = read(scene);
      EXPECT_LT(outcome.worst(), kRight) << name;
      EXPECT_EQ(outcome.number, Vector::LinSpaced(60000, 0.0, 59999.0)) << name;
      EXPECT_THAT(outcome.doubts, Contains(HasSubstr("60000 samples"))) << name;
    }
  }
}

TEST(XdfClocks, ChunksOutOfOrderAreSortedThoughStampsJitter) {
  for (const double deviation : {0.002, 0.008}) {
    Scene scene;
    scene.hz = 500.0;
    scene.in_chunk = 64;
    scene.jitter = 0.0;
    scene.late = [=](int k) { return deviation * normal(k / 64); };
    scene.shuffle = [](auto& chunks) { std::swap(chunks[100], chunks[101]); };
    const Outcome outcome = read(scene);
    EXPECT_LT(outcome.worst(), 1e-3);  // what is left of the jitter
    EXPECT_THAT(outcome.doubts, Contains(HasSubstr("128 of 30000 samples"))) << deviation;
  }
}

TEST(XdfClocks, AChunkThatIsThereTwiceIsABreak) {
  Scene scene;
  scene.shuffle = [](auto& chunks) { chunks.insert(chunks.begin() + 100, chunks[100]); };
  EXPECT_THAT(read(scene).doubts, Contains(AllOf(HasSubstr("a break of"), HasSubstr("-0.19"))));
}

TEST(XdfClocks, LostSamplesAreABreak) {
  Scene scene;
  scene.lost = [](int k) { return k >= 20000 && k < 20020; };
  const Outcome outcome = read(scene);
  EXPECT_LT(outcome.worst(), kRight);
  EXPECT_THAT(outcome.doubts, Contains(AllOf(HasSubstr("a break of"), HasSubstr("0.021"))));
  scene.lost = [](int k) { return k % 1500 < 20; };
  EXPECT_LT(read(scene).worst(), kRight);
}

// ---- clocks as they are ----

TEST(XdfClocks, HonestClocksAreNotAccused) {
  const auto bent = [](double t) { return 1e-6 * (60.0 * t - 0.02 * t * t); };  // 60 ppm, to 36 within 10 minutes
  const auto hiccup = [](int k) { return k % 7001 < 30 ? 0.001 * (30 - k % 7001) : 0.0; };
  const auto by_chunk = [](int samples, double deviation) {
    return [=](int k) { return deviation * normal(k / samples); };
  };
  const auto outliers = [](double size, double share) {
    return [=](double t) { return normal(static_cast<int>(t)) > numeric::normal_quantile(1.0 - share) ? size : 0.0; };
  };
  // A clock that is slewed by 20 ms at 500 ppm.
  const auto slewed = [](double t) { return 5e-4 * std::clamp(t - 100.0, 0.0, 40.0); };
  struct Twin {
    std::string name;
    double right;  ///< [s], what noise and jitter leave
    std::function<void(Scene&)> change;
  };
  const auto noise = [](double deviation) {
    return [=](Scene& s) {
      s.noise = deviation;
      s.seconds = 300.0;
    };
  };
  const auto ahead = [](OfTime clock, double seconds, double hz) {
    return [=](Scene& s) {
      s.ahead = clock;
      s.seconds = seconds;
      s.hz = hz;
    };
  };
  const auto wrong = [](OfTime offset, double seconds) {
    return [=](Scene& s) {
      s.wrong = offset;
      s.seconds = seconds;
    };
  };
  const auto late = [](std::function<double(int)> seconds, double hz) {
    return [=](Scene& s) {
      s.late = seconds;
      s.hz = hz;
    };
  };
  const auto every = [](double seconds) { return [=](Scene& s) { s.every = seconds; }; };
  const auto and_also = [](auto one, auto other) {
    return [=](Scene& s) {
      one(s);
      other(s);
    };
  };
  const Twin twins[] = {
      {"10 ppm", kRight, ahead(drift(10.0), 60.0, 1000.0)},
      {"-100 ppm", kRight, ahead(drift(-100.0), 60.0, 1000.0)},
      {"45 Hz", kRight, ahead(drift(20.0), 60.0, 45.0)},
      {"5000 Hz", kRight, and_also(ahead(drift(20.0), 20.0, 5000.0), every(2.0))},
      {"no drift, exact numbers", kRight,
       and_also(ahead(drift(0.0), 60.0, 1000.0), [](Scene& s) { s.noise = s.jitter = 0.0; })},
      {"a drift that changes", kRight, ahead(bent, 600.0, 200.0)},
      {"a drift that changes, samples even on the sender's clock", 2 * kRight,
       and_also(ahead(bent, 600.0, 200.0), [](Scene& s) { s.even_on_sender = true; })},
      {"a drift that changes, Wi-Fi", 1e-3, and_also(ahead(bent, 600.0, 200.0), [](Scene& s) { s.noise = 1e-3; })},
      {"a clock that is slewed", kRight, ahead(slewed, 300.0, 200.0)},
      {"Wi-Fi, 0.1 ms", kRight, noise(1e-4)},
      {"Wi-Fi, 1 ms", 5e-4, noise(1e-3)},
      {"Wi-Fi, 5 ms", 3e-3, noise(5e-3)},
      {"outliers of 30 ms", 5e-4, and_also(noise(5e-4), wrong(outliers(0.030, 0.1), 300.0))},
      {"one corrupt offset", kRight, wrong([](double t) { return std::abs(t - 30.3) < 1.0 ? 3.0 : 0.0; }, 60.0)},
      {"the first one corrupt", kRight, wrong([](double t) { return t < 1.0 ? 3.0 : 0.0; }, 60.0)},
      {"the last one corrupt", kRight, wrong([](double t) { return t > 54.0 ? 0.030 : 0.0; }, 60.0)},
      {"one offset", kRight, and_also(ahead(drift(0.0), 60.0, 1000.0), every(100.0))},
      {"two offsets", kRight, every(40.0)},
      {"three offsets", kRight, every(20.0)},
      {"jitter of a sample", kRight, [](Scene& s) { s.jitter = 1e-3; }},
      {"jitter of five samples", 2 * kRight, [](Scene& s) { s.jitter = 5e-3; }},
      {"chunks of 32, stamped within 10 ms", 1e-3, late(by_chunk(32, 0.010), 500.0)},
      {"chunks of 4, stamped within 10 ms", 1e-3, late(by_chunk(4, 0.010), 500.0)},
      {"chunks of 64, stamped within 10 ms", 1e-3, late(by_chunk(64, 0.010), 1000.0)},
      {"hiccups of 30 ms", kRight, late(hiccup, 1000.0)},
      {"irregular", kRight,
       [](Scene& s) {
         s.nominal = 0.0;
         s.lost = [](int k) { return k * 7919 % 13 < 9; };
       }},
      {"Wi-Fi and lost samples", 1e-3,
       and_also(noise(2e-3),
                [](Scene& s) {
                  s.nominal = 0.0;
                  s.lost = [](int k) { return k % 3001 < k % 17; };
                })},
  };
  for (const auto& [name, right, change] : twins) {
    Scene scene;
    change(scene);
    const Outcome outcome = read(scene);
    EXPECT_THAT(outcome.doubts, testing::IsEmpty()) << name;
    EXPECT_LT(outcome.worst(), right) << name;
    EXPECT_TRUE(std::ranges::is_sorted(outcome.number)) << name;
  }
}

TEST(XdfClocks, WhatIsDoneForHonestClocksIsReported) {
  const auto said = [](const std::function<void(Scene&)>& change) {
    Scene scene;
    change(scene);
    return read(scene).said;
  };
  EXPECT_THAT(said([](Scene& s) { s.jitter = 5e-3; }), Contains(HasSubstr("jitter")));
  EXPECT_THAT(said([](Scene& s) { s.wrong = [](double t) { return t < 1.0 ? 3.0 : 0.0; }; }),
              Contains(HasSubstr("outlier")));
  EXPECT_THAT(said([](Scene& s) { s.every = 100.0; }), Contains(HasSubstr("60 s")));
  EXPECT_THAT(said([](Scene& s) {
                s.seconds = 300.0;
                s.hz = 100.0;
                s.ahead = [](double t) { return 5e-4 * std::clamp(t - 100.0, 0.0, 40.0); };
              }),
              Contains(HasSubstr("curve")));
  EXPECT_THAT(said([](Scene&) {}), testing::SizeIs(3));
}

TEST(XdfClocks, WithoutAnOffsetTimeIsThatOfTheSender) {
  Scene scene;
  scene.every = 0.0;
  scene.ahead = drift(0.0);
  const Outcome outcome = read(scene);
  EXPECT_LT((outcome.error.array() + 1000.0).abs().maxCoeff(), kRight);
  EXPECT_THAT(outcome.doubts, testing::IsEmpty());
}

}  // namespace xdf_clocks_test
}  // namespace mbk::recording
