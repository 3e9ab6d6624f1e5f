#include "mbk/base/dsp/filter_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "mbk/base/dsp/decimated_chain.h"
#include "mbk/base/dsp/simd_lanes.h"

namespace mbk::dsp {
namespace {

/// Columns that go side by side, and what is made of them.
struct Batch {
  std::vector<Index> columns;    ///< at most kLanes
  std::vector<int> derivatives;  ///< at most kMaxDerivatives
  struct Output {
    std::size_t from;  ///< 4·(place in derivatives) + place in columns
    Index to;          ///< column of the answer
  };
  std::vector<Output> outputs;

  /// Takes in an output, where there is room for it.
  bool add(const FilterOutput& output, Index to) {
    const auto lane = place(columns, output.column), order = place(derivatives, output.derivative);
    if (lane == kLanes || order == kMaxDerivatives) return false;
    if (lane == columns.size()) columns.push_back(output.column);
    if (order == derivatives.size()) derivatives.push_back(output.derivative);
    outputs.push_back({kLanes * order + lane, to});
    return true;
  }

 private:
  template <class Value>
  static std::size_t place(const std::vector<Value>& list, Value value) {
    return static_cast<std::size_t>(std::ranges::find(list, value) - list.begin());
  }
};

std::vector<Batch> batches_of(std::span<const FilterOutput> outputs) {
  std::vector<Batch> batches;
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const auto to = static_cast<Index>(k);
    if (std::ranges::any_of(batches, [&](Batch& batch) { return batch.add(outputs[k], to); })) continue;
    batches.emplace_back().add(outputs[k], to);
  }
  return batches;
}

/// The columns of a batch; a lane without a column repeats the first one.
FourColumns lanes_of(const Batch& batch, std::span<const Column> columns) {
  FourColumns lanes{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const Index column = batch.columns[lane < batch.columns.size() ? lane : 0];
    lanes[lane] = columns[static_cast<std::size_t>(column)].data();
  }
  return lanes;
}

FourValues values_at(const FourColumns& lanes, Index i) {
  return {lanes[0][i], lanes[1][i], lanes[2][i], lanes[3][i]};
}

/// The value as far beyond an end as `inside` lies within it.
double continued(Extension how, double end, double inside) {
  switch (how) {
    case Extension::odd:
      return 2.0 * end - inside;
    case Extension::even:
      return inside;
    case Extension::constant:
      return end;
  }
  return end;
}

/// Smoothed rows with room for the padding before and after them.
struct Padded {
  Interleaved rows;
  Index padding;
  Padded(Index count, Index padding_samples, Index width)
      : rows(count + 2 * padding_samples, width), padding(padding_samples) {}
  [[nodiscard]] double* row(Index i) { return rows.row(padding + i); }

  /// Continues the rows beyond the end at row `end`, to the side on which `outward` (1 or −1) points.
  void extend(Extension how, Index end, Index outward) {
    for (Index i = 1; i <= padding; ++i) {
      for (Index lane = 0; lane < rows.width(); ++lane) {
        row(end + outward * i)[lane] = continued(how, row(end)[lane], row(end - outward * i)[lane]);
      }
    }
  }
};

Result<Index> length_of(std::span<const Column> columns) {
  const Index length = columns.empty() ? 0 : columns.front().size();
  for (const Column& column : columns) {
    if (column.size() != length) {
      return bad_data(fmt::format("signals of {} and {} samples cannot be filtered together", length, column.size()));
    }
  }
  return length;
}

/// Samples that the smoothing filter leaves of `length`.
Result<Index> smoothed_length(const FilterChain& chain, Index length) {
  const Index left = length - chain.smoothing.window + 1;
  if (left < 1) {
    return bad_data(
        fmt::format("{} samples are fewer than the Savitzky–Golay window of {}", length, chain.smoothing.window),
        "use a longer recording or a smaller --sg-window");
  }
  if (!chain.lowpass.empty() && left <= chain.padding.samples) {
    return bad_data(fmt::format("{} samples are too few for zero-phase filtering with a padding of {}", left,
                                chain.padding.samples),
                    "use a longer interval");
  }
  return left;
}

/// Where the outputs of a batch go, in fours: columns of the answer, and constants to add to them.
struct Group {
  std::array<double*, kLanes> to{};
  FourValues plus{};
};

/// What a row of outputs is made of, in whole groups of four, and where it goes.
struct Layout {
  std::vector<std::size_t> picks;  ///< 4·derivative + lane
  std::vector<Group> groups;

  Layout(const Batch& batch, const FourValues& reference, std::span<double* const> answer) {
    for (const auto& [from, to] : batch.outputs) {
      const std::size_t place = picks.size() % kLanes;
      if (place == 0) groups.emplace_back();
      picks.push_back(from);
      groups.back().to[place] = answer[static_cast<std::size_t>(to)];
      if (batch.derivatives[from / kLanes] == 0) groups.back().plus[place] = reference[from % kLanes];
    }
    while (picks.size() % kLanes != 0) {  // whatever keeps pairs of lanes together
      const bool second = picks.size() % 2 != 0 && picks.back() % 2 == 0;
      picks.push_back(second ? picks.back() + 1 : picks.front() / 2 * 2);
    }
  }
  [[nodiscard]] Index width() const { return static_cast<Index>(picks.size()); }

  /// Rows [first, first + count) into the answer.
  void take_out(Padded& rows, Index first, Index count, double gain) const {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      std::array<double*, kLanes> to = groups[g].to;
      for (double*& column : to) column = column == nullptr ? nullptr : column + first;
      separate(rows.row(first) + kLanes * g, width(), count, gain, groups[g].plus, to);
    }
  }
};

/// Each output separately: where there are no running sums.
Result<void> smooth_directly(const FilterChain& chain, std::span<const Column> columns,
                             std::span<const FilterOutput> outputs, Hertz rate, std::span<double* const> to) {
  Matrix smoothed;
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const Column& column = columns[static_cast<std::size_t>(outputs[k].column)];
    const auto one = MBK_TRY(savitzky_golay(chain.smoothing, outputs[k].derivative, column, rate));
    smoothed.conservativeResize(one.rows(), static_cast<Index>(outputs.size()));
    smoothed.col(static_cast<Index>(k)) = one;
  }
  if (!chain.lowpass.empty()) {
    smoothed = MBK_TRY(filter_zero_phase(chain.lowpass, smoothed, chain.padding));
  }
  for (std::size_t k = 0; k < to.size(); ++k) {
    Eigen::Map<Vector>(to[k], smoothed.rows()) = smoothed.col(static_cast<Index>(k));
  }
  return {};
}

/// Columns with `window` − 1 rows before the present chunk, in the first cache.
class RollingRows {
 public:
  RollingRows(FourColumns columns, const FourValues& less, double gain, Index window, Index chunk)
      : columns_(columns), less_(less), gain_(gain), before_(window - 1), chunk_(chunk), rows_(before_ + chunk) {
    read(before_, rows_.row(0));
  }
  /// The rows of `count` positions of the window from where it stands; all but the last time as many as the chunk.
  const double* next(Index count) {
    if (moved_) std::copy_n(rows_.row(chunk_), rows_.width() * before_, rows_.row(0));
    moved_ = true;
    read(count, rows_.row(before_));
    return rows_.row(0);
  }

 private:
  void read(Index count, double* to) {
    interleave(columns_, count, less_, gain_, to);
    for (const double*& column : columns_) column += count;
  }
  FourColumns columns_;
  FourValues less_;
  double gain_;
  Index before_, chunk_;
  Interleaved rows_;
  bool moved_ = false;
};

/// Every row of one batch. What has been smoothed goes on to the low-pass while it is still in the first cache; the
/// last rows wait until they have been continued beyond the end.
void filter_batch(const FilterChain& chain, const RunningSums& sums, const FourColumns& columns, Index count,
                  const FourValues& reference, const Layout& layout) {
  constexpr Index kAtLeast = 256;
  const Index chunk = 2 * sums.half * (kAtLeast / (2 * sums.half) + 1);
  const bool lowpass = !chain.lowpass.empty();
  const double gain = OneWay::gain(chain.lowpass);
  RollingRows raw(columns, reference, gain, chain.smoothing.window, chunk);
  Padded rows(count, lowpass ? chain.padding.samples : 0, layout.width());
  OneWay forward(chain.lowpass, layout.width());
  Index filtered = -rows.padding;
  bool begun = false;
  for (Index done = 0; done < count;) {
    const Index some = std::min(chunk, count - done);
    smooth(sums, raw.next(some), some, layout.picks, rows.row(done));
    done += some;
    if (!lowpass) {
      layout.take_out(rows, done - some, some, 1.0);
      continue;
    }
    if (done <= rows.padding) continue;
    if (!begun) {
      rows.extend(chain.padding.extension, 0, -1);
      forward.settle(rows.row(-rows.padding));
      begun = true;
    }
    Index end = done - rows.padding - 1;
    if (done == count) {
      rows.extend(chain.padding.extension, count - 1, 1);
      end = count + rows.padding;
    }
    if (end > filtered) forward.run(rows.row(filtered), end - filtered, 1);
    filtered = std::max(filtered, end);
  }
  if (!lowpass) return;

  OneWay backward(chain.lowpass, layout.width());
  backward.settle(rows.row(filtered - 1));
  backward.run(rows.row(filtered - 1), rows.padding, -1);
  for (Index end = count; end > 0; end -= chunk) {
    const Index begin = std::max<Index>(0, end - chunk);
    backward.run(rows.row(end - 1), end - begin, -1);
    layout.take_out(rows, begin, end - begin, gain);
  }
}

/// Every row.
Result<void> filter_all(const FilterChain& chain, std::span<const Column> columns,
                        std::span<const FilterOutput> outputs, Hertz rate, std::span<double* const> to) {
  if (!has_running_sums(chain.smoothing) || !OneWay::can_run(chain.lowpass)) {
    return smooth_directly(chain, columns, outputs, rate, to);
  }
  const Index count = columns.front().size() - chain.smoothing.window + 1;
  for (const Batch& batch : batches_of(outputs)) {
    const auto sums = MBK_TRY(running_sums(chain.smoothing, batch.derivatives, rate.value));
    const FourColumns lanes = lanes_of(batch, columns);
    const FourValues reference = values_at(lanes, 0);  // sums of differences keep the digits that sums of values lose
    filter_batch(chain, sums, lanes, count, reference, Layout(batch, reference, to));
  }
  return {};
}

/// Every so many rows, where blocks of samples can do; whether they can.
Result<bool> filter_blocks(const FilterChain& chain, std::span<const Column> columns,
                           std::span<const FilterOutput> outputs, Index every, Hertz rate,
                           std::span<double* const> to) {
  const Index length = columns.front().size(), count = (length - chain.smoothing.window) / every + 1;
  for (const Batch& batch : batches_of(outputs)) {
    const auto blocks = MBK_TRY(DecimatedChain::plan(chain, batch.derivatives, rate, every));
    if (!blocks || length < blocks->shortest()) return false;
    const FourColumns lanes = lanes_of(batch, columns);
    const FourValues reference = values_at(lanes, 0);
    const std::size_t width = kLanes * batch.derivatives.size();
    const auto values = std::make_unique_for_overwrite<double[]>(width * static_cast<std::size_t>(count));
    blocks->run(lanes, length, reference, values.get());
    for (std::size_t order = 0; order < batch.derivatives.size(); ++order) {
      std::array<double*, kLanes> lane_to{};
      for (const auto& [from, target] : batch.outputs) {
        if (from / kLanes == order) lane_to[from % kLanes] = to[static_cast<std::size_t>(target)];
      }
      separate(values.get() + kLanes * order, static_cast<Index>(width), count, 1.0,
               batch.derivatives[order] == 0 ? reference : FourValues{}, lane_to);
    }
  }
  return true;
}

std::vector<double*> columns_of(Matrix& matrix) {
  std::vector<double*> columns;
  for (Index k = 0; k < matrix.cols(); ++k) columns.push_back(matrix.col(k).data());
  return columns;
}

}  // namespace

Result<Index> rows_left(const FilterChain& chain, Index samples, Index every) {
  if (every < 1) return bad_usage(fmt::format("a decimation factor of {} is too small", every), "choose 1 or more");
  const auto left = MBK_TRY(smoothed_length(chain, samples));
  return (left - 1) / every + 1;
}

Result<void> smooth_then_lowpass(const FilterChain& chain, std::span<const Column> columns,
                                 std::span<const FilterOutput> outputs, Hertz sample_rate, Index every,
                                 std::span<double* const> to) {
  const auto length = MBK_TRY(length_of(columns));
  const auto rows = MBK_TRY(rows_left(chain, length, every));
  if (every == 1) return filter_all(chain, columns, outputs, sample_rate, to);

  const auto some = MBK_TRY(filter_blocks(chain, columns, outputs, every, sample_rate, to));
  if (some) return {};
  Matrix all(length - chain.smoothing.window + 1, static_cast<Index>(outputs.size()));
  MBK_TRY(filter_all(chain, columns, outputs, sample_rate, columns_of(all)));
  for (std::size_t k = 0; k < to.size(); ++k) {
    Eigen::Map<Vector>(to[k], rows) = all(Eigen::seqN(0, rows, every), static_cast<Index>(k));
  }
  return {};
}

Result<Matrix> smooth_then_lowpass(const FilterChain& chain, std::span<const Column> columns,
                                   std::span<const FilterOutput> outputs, Hertz sample_rate, Index every) {
  const auto length = MBK_TRY(length_of(columns));
  const auto rows = MBK_TRY(rows_left(chain, length, every));
  Matrix answer(rows, static_cast<Index>(outputs.size()));
  MBK_TRY(smooth_then_lowpass(chain, columns, outputs, sample_rate, every, columns_of(answer)));
  return answer;
}

}  // namespace mbk::dsp
