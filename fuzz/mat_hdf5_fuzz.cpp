// Any HDF5 file, from MATLAB or not, becomes a recording or is rejected with a one-line error.

#include "fuzz/fuzz.h"
#include "fuzz/hdf5_seeds.h"
#include "mbk/files/hdf5/write_hdf5.h"
#include "mbk/files/recording/encode.h"
#include "mbk/files/recording/hdf5_recording.h"

namespace mbk::fuzz {
namespace {

/// Attributes that change numbers, a series with a clock, an array of three dimensions.
std::string hdf5_with_attributes() {
  const auto number = [](double value, hdf5::Stored stored = hdf5::Stored::float64) {
    return hdf5::Value{{}, hdf5::Numbers{Vector::Constant(1, value), stored}};
  };
  const auto numbers = [](std::vector<std::uint64_t> shape, hdf5::Stored stored) {
    std::uint64_t count = 1;
    for (const std::uint64_t side : shape) count *= side;
    return hdf5::Dataset{
        {std::move(shape),
         hdf5::Numbers{Vector::LinSpaced(static_cast<Index>(count), 0.0, static_cast<double>(count - 1)), stored}},
        {}};
  };
  hdf5::Group root;
  root.attributes = {{"_NCProperties", hdf5::one_text("2")}, {"fs", number(1000.0)}};
  hdf5::Dataset& force = root.datasets["force_x"] = numbers({6}, hdf5::Stored::int16);
  force.attributes = {{"scale_factor", number(0.5)},
                      {"add_offset", number(1.0)},
                      {"_FillValue", number(3.0)},
                      {"_Unsigned", hdf5::one_text("true")},
                      {"units", hdf5::one_text("newtons")},
                      {"valid_max", number(4.0, hdf5::Stored::int16)},
                      {"gain", number(2.0)}};
  root.datasets["time"] = numbers({6}, hdf5::Stored::int64);
  root.datasets["time"].attributes["units"] = hdf5::one_text("ns since 1970-01-01");
  root.datasets["cube"] = numbers({2, 3, 2}, hdf5::Stored::float32);
  hdf5::Group& series = root.groups["s"];
  series.attributes["neurodata_type"] = hdf5::one_text("TimeSeries");
  series.datasets["data"] = numbers({3, 2}, hdf5::Stored::float64);
  series.datasets["data"].attributes = {{"conversion", number(2.0)}, {"offset", number(1.0)}};
  series.datasets["channel_conversion"] = numbers({2}, hdf5::Stored::float64);
  series.datasets["starting_time"] = {number(0.5), {{"rate", number(100.0, hdf5::Stored::float32)}}};
  return hdf5::serialise(root).value();
}

}  // namespace

std::vector<std::string> seeds() {
  return {recording::encode_hdf5(small_recording()).value(), recording::encode_mat_hdf5(small_recording()).value(),
          hdf5_of_others(), hdf5_with_attributes()};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mbk::fuzz::check_decoded(mbk::recording::decode_hdf5(mbk::fuzz::bytes_of(data, size)), size);
  return 0;
}
