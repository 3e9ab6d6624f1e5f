#pragma once

#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "mbk/model/trial/inspection.h"
#include "mbk/model/trial/recording.h"

namespace mbk::preprocess::testing_support {

/// Time of sample i is i/rate.
inline Recording even_recording(Index samples, double rate,
                                const std::vector<std::pair<std::string, Vector>>& channels) {
  Recording recording;
  recording.time.resize(samples);
  for (Index i = 0; i < samples; ++i) recording.time[i] = static_cast<double>(i) / rate;
  for (const auto& [name, values] : channels) recording.channels.push_back({name, "", "base", values});
  return recording;
}

inline Vector& values_of(Recording& recording, const std::string& name) {
  for (Channel& channel : recording.channels) {
    if (channel.name == name) return channel.values;
  }
  return recording.time;
}

/// About a standard normal number, the same on every platform: the sum of twelve uniform ones.
inline double normal(std::mt19937& random) {
  double sum = -6.0;
  for (int k = 0; k < 12; ++k) sum += static_cast<double>(random()) / 4294967296.0;
  return sum;
}

/// What `prepare` reads of an inspection, counted plainly.
inline Inspection facts_of(const Recording& recording) {
  Inspection facts;
  const Vector& t = recording.time;
  facts.samples = t.size();
  facts.duration = t.size() > 0 ? t[t.size() - 1] - t[0] : 0.0;
  std::vector<double> intervals;
  for (Index i = 1; i < t.size(); ++i) {
    const double interval = t[i] - t[i - 1];
    if (interval > 0.0) intervals.push_back(interval);
    if (interval == 0.0) ++facts.duplicated_times;
    if (interval < 0.0) ++facts.backward_times;
  }
  std::sort(intervals.begin(), intervals.end());
  facts.interval_median =
      intervals.empty() ? std::numeric_limits<double>::quiet_NaN() : intervals[intervals.size() / 2];
  facts.rate_hz = 1.0 / facts.interval_median;
  for (Index i = 1; i < t.size(); ++i) {
    if (t[i] - t[i - 1] > 1.5 * facts.interval_median) facts.gaps.push_back({i - 1, t[i - 1], t[i] - t[i - 1]});
  }
  return facts;
}

}  // namespace mbk::preprocess::testing_support
