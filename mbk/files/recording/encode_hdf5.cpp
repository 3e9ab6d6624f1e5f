#include <fmt/format.h>

#include "mbk/base/core/version.h"
#include "mbk/files/hdf5/write_hdf5.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/encode.h"

namespace mbk::recording {
namespace {

hdf5::Dataset series(const Vector& values) {
  return {{{static_cast<std::uint64_t>(values.size())}, hdf5::Numbers{values, hdf5::Stored::float64}}, {}};
}

hdf5::Dataset time_series(const Vector& values) {
  hdf5::Dataset dataset = series(values);
  dataset.attributes["unit"] = hdf5::one_text("s");
  return dataset;
}

}  // namespace

hdf5::Group hdf5_events(const std::vector<Event>& events) {
  Vector times(std::ssize(events)), values(std::ssize(events));
  hdf5::Texts names;
  for (std::size_t k = 0; k < events.size(); ++k) {
    times[static_cast<Index>(k)] = events[k].time;
    values[static_cast<Index>(k)] = events[k].value;
    names.push_back(events[k].name);
  }
  hdf5::Group group;
  group.datasets["time"] = time_series(times);
  group.datasets["value"] = series(values);
  group.datasets["name"] = {{{names.size()}, std::move(names)}, {}};
  return group;
}

Result<std::string> encode_hdf5(const Recording& recording) {
  hdf5::Group root;
  root.attributes["software"] = hdf5::one_text(fmt::format("mbk {}", version()));
  for (const auto& [key, value] : metadata_with_joints(recording)) {
    if (key == "format") {
      return bad_data("metadata 'format' cannot be written because this attribute is reserved for the file layout",
                      "rename that entry");
    }
    root.attributes[key] = hdf5::one_text(value);
  }
  root.attributes["format"] = hdf5::one_text(std::string(kLayout));
  root.datasets["time"] = time_series(recording.time);
  hdf5::Group& channels = root.groups["channels"];
  for (const Channel& channel : recording.channels) {
    hdf5::Dataset& dataset = channels.datasets[channel.name] = series(channel.values);
    dataset.attributes["unit"] = hdf5::one_text(channel.unit);
    dataset.attributes["frame"] = hdf5::one_text(channel.frame);
  }
  if (!recording.events.empty()) root.groups["events"] = hdf5_events(recording.events);
  return hdf5::serialise(root);
}

}  // namespace mbk::recording
