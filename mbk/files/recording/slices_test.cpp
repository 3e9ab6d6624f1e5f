#include "mbk/files/recording/slices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mbk::recording {
namespace slices_test {

using testing::ElementsAre;
using testing::HasSubstr;

/// An array whose numbers count from 0 in the order of the file.
Array counted(std::vector<std::uint64_t> shape, bool row_major = false) {
  Array array;
  array.name = "data";
  Index size = 1;
  for (const std::uint64_t side : shape) size *= static_cast<Index>(side);
  if (shape.size() > 2) {
    array.shape = shape;
    array.values = Matrix(Vector::LinSpaced(size, 0.0, static_cast<double>(size - 1)));
  } else {
    array.values = Matrix(Matrix::Zero(static_cast<Index>(shape[0]), static_cast<Index>(shape[1])));
  }
  array.row_major = row_major;
  return array;
}

TEST(SlicedSource, IsWrittenAsInMatlabOrNumpy) {
  EXPECT_THAT(sliced_source("pos[:,2]")->at, ElementsAre(0, 2));
  EXPECT_EQ(sliced_source("out.signals(1).values (:, 2, 3)")->name, "out.signals(1).values");
  EXPECT_THAT(sliced_source("data[trial,:,7]")->at, ElementsAre(-1, 0, 7));
  for (const char* other : {"pos[2]", "pos(1,2)", "force (N)", "[:,1]", "pos[:,0]", "pos[:,-1]", "pos[:,1", "pos[::2]",
                            "a[:,99999999999999999999]"}) {
    EXPECT_FALSE(sliced_source(other)) << other;
  }
}

struct Found {
  Index along, trial, begin, stride, length;
  bool operator==(const Found&) const = default;
};

Found found(const Array& array, const char* source, Index trial = 1) {
  const auto plan = plan_of(array, *sliced_source(source));
  EXPECT_TRUE(plan) << plan.error().line();
  if (!plan) return {};
  const Slice slice = slice_of(array, *plan, trial);
  return {static_cast<Index>(plan->along), plan->trial ? static_cast<Index>(*plan->trial) : -1, slice.begin,
          slice.stride, slice.length};
}

TEST(PlanOf, FindsTimeAndTrials) {
  const Array trials_first = counted({3, 20, 2}), trials_last = counted({20, 2, 3}, true);
  EXPECT_EQ(found(trials_first, "data[trial,:,2]", 3), (Found{1, 0, 2 + 3 * 20, 3, 20}));
  EXPECT_EQ(found(trials_first, "data[:,:,2]", 3), (Found{1, 0, 2 + 3 * 20, 3, 20}));
  EXPECT_EQ(found(trials_first, "data(2,:,1)"), (Found{1, -1, 1, 3, 20}));
  EXPECT_EQ(found(trials_last, "data[:,2]", 3), (Found{0, 2, 3 + 2, 6, 20}));
  EXPECT_EQ(found(trials_last, "data[:,2,1]"), (Found{0, -1, 3, 6, 20}));
  EXPECT_EQ(found(counted({20, 2}), "data[:,2]"), (Found{0, -1, 20, 1, 20}));
  EXPECT_EQ(found(counted({3, 20}), "data[trial,:]", 2), (Found{1, 0, 1, 3, 20}));
  EXPECT_EQ(found(counted({1, 20, 2}), "data[trial,:,2]"), (Found{1, 0, 20, 1, 20}));
}

std::string error_of(const Array& array, const char* source) {
  const auto plan = plan_of(array, *sliced_source(source));
  return plan ? "none" : plan.error().line();
}

TEST(PlanOf, RefusesWhatMayBeTakenInTwoWays) {
  const Array close = counted({30, 50, 2});
  EXPECT_THAT(error_of(close, "data[:,:,1]"), AllOf(HasSubstr("':'"), HasSubstr("'trial'")));
  EXPECT_EQ(error_of(close, "data[:,trial,1]"), "none");
  // Of trials by samples by channels, this would be one sample of each trial.
  EXPECT_THAT(error_of(counted({40, 2000, 6}), "data[:,2]"), HasSubstr("data[trial,:,1]"));
  EXPECT_THAT(error_of(close, "data[trial,2]"), AllOf(HasSubstr("slice"), HasSubstr("':'")));
  EXPECT_THAT(error_of(close, "data[trial,:,trial]"), AllOf(HasSubstr("slice"), HasSubstr("':'")));
  EXPECT_THAT(error_of(close, "data[:]"), AllOf(HasSubstr("slice"), HasSubstr("':'")));
  EXPECT_THAT(error_of(close, "data[1,:,3]"), HasSubstr("dimension 3"));
  EXPECT_THAT(error_of(close, "data[1,:,1,1]"), AllOf(HasSubstr("'data'"), HasSubstr("30×50×2"), HasSubstr(" 4 ")));
}

TEST(ExampleSlice, TakesTheLongestDimensionForTime) {
  EXPECT_EQ(example_slice(counted({40, 2000, 6}), 2), "data[trial,:,2]");
  EXPECT_EQ(example_slice(counted({2000, 6, 40}), 2), "data[:,2,trial]");
  EXPECT_EQ(example_slice(counted({6, 40, 2000}), 1), "data[1,trial,:]");
}

}  // namespace slices_test
}  // namespace mbk::recording
