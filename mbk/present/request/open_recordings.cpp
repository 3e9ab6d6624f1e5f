#include "mbk/present/request/open_recordings.h"

#include <utility>

#include "mbk/files/recording/in_memory.h"

namespace mbk::request {
namespace {

using measurement::RecordingReader;

/// All of them, or the first error.
Result<std::vector<Recording>> all_of(const ReadRequest& request, const SensorRequest& sensor,
                                      Result<Recording> (RecordingReader::*read)(int) const) {
  const auto reader = MBK_TRY(open_recordings(request, sensor));
  std::vector<Recording> recordings;
  for (int k = 0; k < reader.count(); ++k) {
    auto one = MBK_TRY((reader.*read)(k));
    recordings.push_back(std::move(one));
  }
  return recordings;
}

}  // namespace

Result<RecordingReader> open_recordings(const ReadRequest& request, const SensorRequest& sensor) {
  measurement::Reading reading;
  reading.files = request.files;
  reading.parts = request.parts;
  reading.options = MBK_TRY(read_options(request));
  reading.sensor = MBK_TRY(sensor_use(sensor));
  reading.in_memory = recording::held_recording;
  return RecordingReader::open(reading);
}

Result<std::vector<Recording>> read_recordings(const ReadRequest& request, const SensorRequest& sensor) {
  return all_of(request, sensor, &RecordingReader::read);
}

Result<std::vector<Recording>> read_perturbations(const ReadRequest& request, const SensorRequest& sensor) {
  return all_of(request, sensor, &RecordingReader::read_perturbation);
}

}  // namespace mbk::request
